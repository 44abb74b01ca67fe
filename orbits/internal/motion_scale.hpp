#pragma once

#include <Eigen/Core>

/// Inside of strobe_map.cpp, orbit_map.cpp and basin_finder.cpp.
namespace slipmode::orbits::detail {

/// (max − min)/2 of each row. What moves less than a thousandth of the farthest counts as that far: its own motion may
/// be the error of the flow, which is relative to the larger ones.
[[nodiscard]] Eigen::VectorXd half_reaches(const Eigen::MatrixXd& samples);

/// What distances of states are measured against: how far each displacement and each velocity goes to either side of
/// its own middle, so that neither a mean nor a larger motion elsewhere hides that a state does not repeat.
class MotionScale {
 public:
  MotionScale() = default;
  /// @param q, v  samples along the cycle, one column per instant [n x T], T ≥ 1
  MotionScale(const Eigen::MatrixXd& q, const Eigen::MatrixXd& v);

  /// Largest difference of states, relative. @param apart  differences (q; q̇) as columns [2n x m]
  [[nodiscard]] double distance(const Eigen::Ref<const Eigen::MatrixXd>& apart) const;

 private:
  Eigen::VectorXd scale_;  ///< of (q; q̇) [2n]; 0: nothing moves
};

}  // namespace slipmode::orbits::detail
