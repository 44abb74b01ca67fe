#pragma once

#include <slipmode/orbits/spectrum.hpp>

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace slipmode::bench {

/// A nonlinear element between a degree of freedom and ground.
struct PeerElement {
  enum class Kind { kJenkins, kPlay } kind = Kind::kJenkins;
  Eigen::Index dof = 0;
  double stiffness = 1.0;
  double reach = 1.0;    ///< limit force over stiffness, or the gap to each side
  double damping = 0.0;  ///< of the stops
};

/// M q̈ + C q̇ + K q + elements = amplitude sin(ωt) at one degree of freedom.
struct PeerProblem {
  Eigen::MatrixXd M, C, K;
  std::vector<PeerElement> elements;
  Eigen::Index driven = 0;
  double omega = 1.0, amplitude = 1.0;
};

struct PeerBalance {
  bool converged = false;
  int iterations = 0;
  std::vector<orbits::Harmonics> displacement;  ///< of every degree of freedom
};

/// Harmonic balance as it is commonly written: coefficients of all degrees of freedom by Newton's method, forces by the
/// alternating frequency-time scheme with FFTW and their derivatives sampled and transformed column by column, linear
/// equations by Eigen. Shares no code with slipmode's. Tables and plans of transforms are made once, as a program for
/// many points would.
class AlternatingScheme {
 public:
  virtual ~AlternatingScheme() = default;
  /// From the linear response with elements taken for springs (Jenkins) or left out (play).
  [[nodiscard]] virtual PeerBalance solve(const PeerProblem& problem) const = 0;
  /// From a neighbour's coefficients.
  [[nodiscard]] virtual PeerBalance solve(const PeerProblem& problem, const PeerBalance& near) const = 0;
};

/// @param samples  > 2 harmonics
/// @return  null where bench is built without FFTW
[[nodiscard]] std::unique_ptr<AlternatingScheme> alternating_scheme(int harmonics, int samples);

}  // namespace slipmode::bench
