#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>
#include <slipmode/pod/basis.hpp>

#include <Eigen/Core>
#include <array>
#include <limits>
#include <string>
#include <vector>

namespace slipmode::diagnostics {

/// A figure from all data and from either half of them; NaN where it could not be had.
struct Halved {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::array<double, 2> halves = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};

  /// Half the difference between the halves: what the figure is uncertain by.
  [[nodiscard]] double spread() const {
    return 0.5 * (halves[1] > halves[0] ? halves[1] - halves[0] : halves[0] - halves[1]);
  }
};

/// What one model's motion is like.
struct ModelFindings {
  std::string name;            ///< "full", "6 POMs"
  Eigen::Index modes = 0;      ///< degrees of freedom
  LyapunovSpectrum exponents;  ///< from the tangent flow
  Halved kaplan_yorke;         ///< of `exponents`
  Halved correlation;          ///< correlation dimension of the record
  Halved delay;                ///< first minimum of mutual information [samples]
  Halved embedding;            ///< dimension by false neighbours; NaN where no dimension is enough
  /// Of the record's averaged amplitude spectrum from the full model's, root mean square, of its root mean square.
  /// Beside the full model: between its own halves, all other halves are compared with the same half of the full model.
  Halved spectrum_distance;
  Halved stick_fraction;                ///< share of the time in stick, mean over contacts whose law sticks
  Eigen::VectorXd record = {};          ///< velocity of the channel [samples]
  std::string failure = {};             ///< why the model gave nothing; empty: it did
  std::vector<std::string> notes = {};  ///< figures that could not be had, and why
};

struct VerdictTable {
  std::vector<ModelFindings> models;  ///< the full one first
  Eigen::Index channel = 0;           ///< degree of freedom whose velocity is the record
  double sample = 0.0;                ///< [s]
};

struct ModelVerdictOptions {
  TangentOptions tangent = {};     ///< transient of all models; duration, interval, number of exponents
  double sample = 0.5;             ///< of the record [s]
  Eigen::Index samples = 20000;    ///< ≥ 2,000
  Eigen::Index channel = -1;       ///< −1: farthest_dof
  Eigen::Index max_lag = 200;      ///< for the delay [samples]
  int max_dimension = 10;          ///< for the embedding
  Eigen::Index references = 3000;  ///< points that neighbour searches examine
  ParallelOptions parallel = {};   ///< models run in parallel; progress counts models
};

/// Full model and reduced ones side by side: exponents, dimensions, delay, embedding, spectrum, share of stick, each
/// with its value in both halves of the data. Every model settles by itself for the transient, the reduced ones from
/// the projection of `start`; then the exponents are measured, and a record taken, from the same state. A model that
/// fails has a line that says so. Same bytes for any number of threads.
/// @throws InvalidInput  for options out of range, a channel that is not there, and as lyapunov_spectrum for the full
///                       model
/// @throws Interrupted   if the stop flag was set
[[nodiscard]] VerdictTable model_verdict(const dynamics::HybridSystem& full, const dynamics::State& start,
                                         const std::vector<pod::NamedBasis>& candidates,
                                         const ModelVerdictOptions& options);

}  // namespace slipmode::diagnostics
