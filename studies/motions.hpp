#pragma once

#include <slipmode/diagnostics/series/spectrum.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/pod/basis.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::studies {

/// Which motions are computed, and how much of each is kept.
struct MotionsRequest {
  std::vector<double> values = {};  ///< belt speeds or frequencies of the drive, in the order they are gone through
  std::vector<bool> recorded = {};  ///< at which of them the motion itself is kept
  std::vector<Eigen::Index> modes = {};  ///< of the reduced models
  /// What is kept of the structure's shape, from the full degrees of freedom [readings x n].
  Eigen::MatrixXd readings = {};
  Eigen::Index samples = 1500;         ///< kept of contacts
  Eigen::Index samples_per_shape = 4;  ///< the shape is kept at every so many
  double periods = 6.0;                ///< of the slowest natural mode, or of the drive that has one, kept
  double spectrum_periods = 40.0;      ///< of which the spectrum is taken
};

/// A settled motion. On a belt from one of its slips on, that from the largest displacement within two slowest periods;
/// under a shaker or a force from its section: so periodic motions of two models are in phase.
struct Motion {
  double interval = 0.0;                     ///< between samples [s]
  Eigen::MatrixXd q, v, lambda;              ///< of the contacts [contacts x samples]
  Eigen::MatrixXd shape;                     ///< readings of the full structure [readings x shapes]
  std::vector<dynamics::Event> events;       ///< of these samples, times from their first
  std::vector<dynamics::ContactMode> modes;  ///< of each contact at the end
  diagnostics::AmplitudeSpectrum spectrum;   ///< of the first contact's velocity
};

/// What a model settles to at a value.
struct MotionPoint {
  double value = 0.0;
  /// Of the first contact the displacements at its slips; under a shaker or a force the scene's reading at each
  /// section.
  std::vector<double> states = {};
  std::string said = {};  ///< "period 1", …
};

/// One model over the values.
struct MotionsOf {
  Eigen::Index modes = 0;                      ///< 0: the full model
  std::vector<MotionPoint> points;             ///< one per value
  std::vector<std::optional<Motion>> motions;  ///< one per recorded value; empty where it failed
};

/// What the full model and reduced ones settle to over a belt's speed or the drive's frequency, settled as [validation]
/// says for its sweep; on a belt each follows its own motion from value to value from the scene's start.
/// @param basis  with as many vectors as the largest model has modes
/// @return       the full model, then the reduced ones in their order
/// @throws InvalidInput  for no values, a scene under a force, more modes than vectors
/// @throws Interrupted   when the stop flag was set
[[nodiscard]] std::vector<MotionsOf> motions(const scene::Scene& scene, const pod::NamedBasis& basis,
                                             const MotionsRequest& request, const RunOptions& run);

}  // namespace slipmode::studies
