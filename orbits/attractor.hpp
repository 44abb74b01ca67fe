#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/pod/basis.hpp>

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace slipmode::orbits {

/// Where a trajectory is cut into passages: at events of one contact, or once per period of the drive.
struct Section {
  int contact = 0;  ///< −1: stroboscopic, at times start + k·T of the drive
  /// Which of its events. Onsets of stick lie on v_rel = 0 alone; releases also on the stick limit.
  dynamics::EventKind event = dynamics::EventKind::kStick;

  [[nodiscard]] static Section stroboscopic() { return {.contact = -1}; }
  [[nodiscard]] bool is_stroboscopic() const { return contact < 0; }
};

/// Stroboscopic for a drive with a period, else onsets of stick of the first contact whose law sticks, else reversals
/// of the first contact.
[[nodiscard]] Section default_section(const dynamics::HybridSystem& system);

/// A measure of distance in which every coordinate counts by how far it moves.
struct Metric {
  Eigen::VectorXd mean, rms;  ///< of (q; q̇) along a motion, rms about the mean [2n]

  /// Mean and rms over the columns of `samples` [2n x S]. @throws InvalidInput  without columns
  [[nodiscard]] static Metric of(const Eigen::MatrixXd& samples);
  /// (x − mean)/(rms √2n), coordinate by coordinate; those that do not move are left out. The root mean square distance
  /// of the motion from its mean is then 1, of two independent points of it √2.
  /// @param points  (q; q̇) as columns [2n x T]
  /// @throws InvalidInput  for points of another size
  [[nodiscard]] Eigen::MatrixXd scaled(const Eigen::MatrixXd& points) const;
};

struct AttractorOptions {
  std::optional<Section> section = {};   ///< absent: default_section
  double transient = 0.0;                ///< run first, nothing kept; under a periodic drive whole periods of it [s]
  double duration = 0.0;                 ///< recorded, > 0 [s]
  double sample = 0.0;                   ///< > 0, between the samples [s]
  std::optional<pod::Basis> basis = {};  ///< of a reduced model: points and samples are then those of the full one
  std::optional<Metric> metric = {};     ///< absent: that of the samples
  dynamics::FlowOptions flow = {.audit = false};
  const StopFlag* stop = nullptr;  ///< polled now and then
};

/// A long motion, seen at a section and at equal intervals. n counts degrees of freedom of the full model.
struct Attractor {
  Section section;
  /// The model's states at the section, in order, just after events. Stroboscopic ones all bear the time of the start,
  /// which is the same phase of the drive: late times would cost digits.
  std::vector<dynamics::State> passages = {};
  double period = 0.0;           ///< between stroboscopic passages; 0 for events [s]
  Eigen::MatrixXd points = {};   ///< (q; q̇) of the passages [2n x T]
  Eigen::MatrixXd samples = {};  ///< (q; q̇), `sample` apart [2n x S]
  Metric metric = {};
  std::optional<pod::Basis> basis = {};  ///< AttractorOptions::basis
};

/// (q; q̇) of states as columns [2n x T], lifted by the basis of a reduced model.
[[nodiscard]] Eigen::MatrixXd points_of(const std::vector<dynamics::State>& states,
                                        const std::optional<pod::Basis>& basis = {});

/// The same for displacements and velocities as columns [L x T].
[[nodiscard]] Eigen::MatrixXd points_of(const Eigen::MatrixXd& q, const Eigen::MatrixXd& v,
                                        const std::optional<pod::Basis>& basis = {});

/// Runs `start` and records it.
/// @throws InvalidInput      for times out of range, a contact that is not there, a stroboscopic section of a drive
///                           without period, and as simulate
/// @throws NumericalFailure  when the motion never crosses the section (as a motion without stick), and as simulate
/// @throws Interrupted       if the stop flag was set
[[nodiscard]] Attractor record_attractor(const dynamics::HybridSystem& system, const dynamics::State& start,
                                         const AttractorOptions& options);

}  // namespace slipmode::orbits
