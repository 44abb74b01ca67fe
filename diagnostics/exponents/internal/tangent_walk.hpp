#pragma once

#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>
#include <slipmode/diagnostics/exponents/phase_volume.hpp>
#include "diagnostics/exponents/internal/energy_metric.hpp"

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace slipmode::diagnostics {

/// Directions in which the motion is not free while these modes rule: velocities of rigid contacts that stick,
/// stretches of contact springs whose contact point slides or that lost contact.
[[nodiscard]] Eigen::Index confined(const dynamics::HybridSystem& system,
                                    const std::vector<dynamics::ContactMode>& modes);

/// A motion with an orthonormal frame of tangent directions, carried interval by interval.
///
/// With all N directions, where PhaseVolume applies, it stops on both sides of every event: a direction that stick
/// takes is dropped, and one that slip gives back, along the contact's impulse, takes its place at the end of the
/// frame. Otherwise directions that are lost stay lost. Source: docs/theory/lyapunov-spectrum.md, sections 3 and 4.
class TangentWalk {
 public:
  /// @param options  exponents, interval, seed and flow are read
  TangentWalk(const dynamics::HybridSystem& system, const dynamics::State& start, const TangentOptions& options);

  /// Goes on to this time, or a little beyond where an event comes then; growth() is then that of this stretch.
  void advance_to(double time);

  /// ln of the growth of every direction during the last advance_to(), those given back included [k].
  [[nodiscard]] const Eigen::VectorXd& growth() const { return growth_; }
  /// Most directions lost at once so far: so many exponents are −∞.
  [[nodiscard]] Eigen::Index lost() const { return lost_; }
  [[nodiscard]] const dynamics::State& state() const { return state_; }
  [[nodiscard]] Eigen::Index exponents() const { return growth_.size(); }
  /// Shortest time between renormalisations that was needed, events apart.
  [[nodiscard]] double shortest() const { return shortest_; }
  /// Sums since the last clear_balance(): integrals, not means. Empty without all directions.
  [[nodiscard]] const std::optional<VolumeBalance>& balance() const { return balance_; }
  void clear_balance();

 private:
  /// Carries the frame over a stretch in pieces that do not let directions collapse; returns the events met.
  std::vector<dynamics::Event> push(double duration);
  void quiet(double duration);
  void cross(double duration);
  [[nodiscard]] std::optional<dynamics::Event> next_event(double within) const;
  /// Turns the directions that slip gave back so that the last one holds what a stick is about to take.
  void offer(const Eigen::VectorXd& normal);
  /// Takes up the direction that slip gives back, along the contact's impulse.
  void append(const Eigen::VectorXd& normal);

  dynamics::HybridSystem system_;
  EnergyMetric metric_;
  dynamics::TangentFlow flow_;
  dynamics::FlowOptions options_;
  dynamics::State state_;
  Eigen::MatrixXd frame_;  ///< in the metric's coordinates
  Eigen::VectorXd growth_;
  Eigen::Index lost_ = 0;
  Eigen::Index dropped_ = -1;  ///< the first column that the last push took out of the frame; −1: none
  double interval_, longest_, shortest_, margin_;
  std::optional<PhaseVolume> volume_ = {};
  std::optional<VolumeBalance> balance_ = {};
};

}  // namespace slipmode::diagnostics
