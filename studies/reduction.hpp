#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/system.hpp>
#include <slipmode/pod/basis.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/shaken_modes.hpp>
#include <slipmode/scene/scene.hpp>

#include <memory>
#include <optional>
#include <string>

namespace slipmode::studies {

/// Proper orthogonal modes of a motion: under a belt or a force `pod`, under a shaker `shaken`.
struct MotionModes {
  scene::Scene scene;              ///< of the motion
  results::Provenance provenance;  ///< of the motion
  Eigen::Index dofs = 0, snapshots = 0;
  std::optional<pod::PodResult> pod;
  std::optional<results::ShakenModes> shaken;
};

/// @param motion  an ensemble, or the samples of a trajectory or an orbit
/// @param modes   kept; 0: all there are
/// @throws InvalidInput  for another kind of result, modes < 0, more modes than there are, a number of modes under
///                       a shaker
[[nodiscard]] MotionModes motion_modes(const results::StoreReader& motion, Eigen::Index modes = 0);
/// The same of snapshots that are here. @param source  what they are from, for messages
[[nodiscard]] MotionModes motion_modes(const scene::Scene& scene, const pod::Ensemble& snapshots, Eigen::Index modes,
                                       const std::string& source);
[[nodiscard]] results::Content content_of(const std::shared_ptr<const MotionModes>& modes);

/// The words of a decomposition, which knows numbers only, with the file and the option that they belong to.
[[nodiscard]] InvalidInput refused_modes(const std::string& source, Eigen::Index modes, const InvalidInput& refusal);

/// What can be said of a number of modes before there is a motion.
/// @throws InvalidInput  for modes < 0, more than degrees of freedom, or a number of modes under a shaker
void require_modes(const scene::Scene& scene, Eigen::Index modes, const std::string& source);

/// A scene's model projected on a basis.
struct Reduction {
  dynamics::HybridSystem full;
  results::ReducedModel model;
  double captured = 0.0;  ///< share of the energy in its modes; NaN: not known
};

/// @param source  with all its vectors
/// @param name    of the basis, for messages
/// @param modes   0: as [reduction] says
/// @throws InvalidInput  for modes < 0, more than there are, or where nothing says how many
[[nodiscard]] Reduction reduce(const scene::Scene& scene, const dynamics::HybridSystem& full,
                               const pod::NamedBasis& source, const std::string& name, Eigen::Index modes = 0);
[[nodiscard]] results::Content content_of(const scene::Scene& scene, const std::shared_ptr<const Reduction>& reduction);

}  // namespace slipmode::studies
