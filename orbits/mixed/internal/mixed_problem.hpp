#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include "orbits/internal/descent.hpp"
#include "orbits/mixed/internal/partition.hpp"

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

namespace slipmode::orbits {

/// What the mixed method solves for.
struct MixedPoint {
  dynamics::State start;     ///< of the near part
  Eigen::VectorXd coupling;  ///< forces of the rest on it [coupled · block]
};

/// One period of the near part under its coupling forces, with everything that Newton's method needs. Scaled.
struct MixedEvaluation {
  MixedPoint point;
  dynamics::State end;
  std::vector<dynamics::Event> events;
  Eigen::VectorXd motion;  ///< Fourier coefficients of the coupled degrees of freedom [coupled · block]
  NewtonSystem newton;
  double norm = std::numeric_limits<double>::infinity();     ///< of newton.r
  double largest = std::numeric_limits<double>::infinity();  ///< its largest entry
};

/// The mixed method's equations as `descend` solves them:
///
///     x_1(T) − x_1(0) = 0,     ĝ − (own + S q̂_1(x_1(0), ĝ)) = 0.
class MixedProblem {
 public:
  using Point = MixedPoint;
  using Evaluation = MixedEvaluation;

  /// @param partition  outlives this
  explicit MixedProblem(const Partition& partition, const dynamics::FlowOptions& flow)
      : partition_(partition), flow_(flow) {}

  /// Contacts' forces in this share, from 0 (excluded) to 1.
  void set_share(double share) { share_ = share; }
  [[nodiscard]] dynamics::HybridSystem system_at(const MixedPoint& point) const {
    return partition_.system_under(point.coupling, share_);
  }
  [[nodiscard]] double period() const;

  /// The first evaluation sets the scales.
  /// @throws NumericalFailure, InvalidInput  as the flow
  [[nodiscard]] MixedEvaluation evaluate(const MixedPoint& point);
  [[nodiscard]] const NewtonSystem& linearised(const MixedEvaluation& at) const { return at.newton; }
  [[nodiscard]] std::optional<MixedPoint> moved(const MixedEvaluation& at, const Eigen::VectorXd& step,
                                                double share) const;
  [[nodiscard]] const Eigen::VectorXd& scale() const { return scale_; }

 private:
  const Partition& partition_;
  dynamics::FlowOptions flow_;
  double share_ = 1.0;
  Eigen::VectorXd scale_;
};

}  // namespace slipmode::orbits
