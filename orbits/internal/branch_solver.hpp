#pragma once

#include <slipmode/orbits/continuation.hpp>
#include "orbits/internal/shooting_problem.hpp"

#include <Eigen/Core>
#include <memory>
#include <optional>

namespace slipmode::orbits {

/// What continuation solves for.
struct BranchUnknowns {
  ShootingPoint point;
  double parameter = 0.0;
  double phase = 0.0;  ///< of the drive at the origin, as a share of its period; kept as its period changes
};

/// A point on (or near) a branch with the linearised conditions there. Scaled unknowns: (x₁ [N], ln T if unknown, p).
struct BranchEvaluation {
  BranchUnknowns at;
  ShootingEvaluation shooting;
  std::shared_ptr<ShootingProblem> problem;
  std::vector<Eigen::MatrixXd> columns;  ///< per segment: of ln T (if unknown) and p [N x e]
  Eigen::MatrixXd J;                     ///< closing conditions, and phase if the period is unknown
  Eigen::VectorXd r;
};

/// Predictor and corrector of a branch. For one thread.
class BranchSolver {
 public:
  using Unknowns = BranchUnknowns;
  using Evaluation = BranchEvaluation;
  static constexpr bool kByShooting = true;  ///< an orbit's origin, and its place in a family, are choices

  /// @param orbit  fixes kind, order and scales
  BranchSolver(dynamics::SystemFamily family, const PeriodicOrbit& orbit, double parameter,
               const ContinuationOptions& options);

  [[nodiscard]] BranchUnknowns unknowns_of(const PeriodicOrbit& orbit, double parameter) const;
  [[nodiscard]] BranchUnknowns unknowns_of(const BranchPoint& point) const {
    return unknowns_of(point.orbit, point.parameter);
  }

  /// @throws NumericalFailure  when the flow fails; InvalidInput when the family does
  [[nodiscard]] BranchEvaluation evaluate(const BranchUnknowns& at) const;

  /// Unit vector along the branch, with a positive product with `along`. Directions of a family of orbits (floating
  /// structures) are kept out of it.
  [[nodiscard]] Eigen::VectorXd tangent(const BranchEvaluation& at, const Eigen::VectorXd& along) const;

  /// The scaled step `step` away from a point.
  [[nodiscard]] BranchUnknowns moved(const BranchEvaluation& from, const Eigen::VectorXd& step, double share) const;

  struct Corrected {
    BranchEvaluation at;
    int iterations = 0;
  };
  /// Newton from `guess` with row · (unknowns − guess) = 0 as the last condition; nothing when it does not converge.
  [[nodiscard]] std::optional<Corrected> correct(const BranchUnknowns& guess, const Eigen::VectorXd& row) const;

  /// One more step, kept if it lowers the residual: what locating points to 1e-9 needs where Φ − 1 is nearly singular.
  [[nodiscard]] BranchEvaluation polished(BranchEvaluation at, const BranchUnknowns& guess,
                                          const Eigen::VectorXd& row) const;

  /// The same orbit with its origin a share of its period later.
  [[nodiscard]] BranchEvaluation shifted(const BranchEvaluation& at, double share) const;

  /// Of a family of orbits, held by contacts behind springs that never slide: the one whose springs' forces reach as
  /// far to one side as to the other, which is there as long as the family is. Nothing where `at` is it, or alone.
  [[nodiscard]] std::optional<BranchEvaluation> middle_of_family(const BranchEvaluation& at,
                                                                 const PeriodicOrbit& orbit) const;

  /// The same of an orbit at the parameter; the orbit itself where none is found.
  [[nodiscard]] PeriodicOrbit in_the_middle(const PeriodicOrbit& orbit, double parameter) const;

  /// b − a, scaled [N + e]; both at the same phase of the drive.
  [[nodiscard]] Eigen::VectorXd difference(const BranchUnknowns& b, const BranchUnknowns& a) const;

  /// The same family solved by half periods, for the symmetric orbits near a point that is nearly symmetric, and the
  /// nearest of them as a guess.
  struct Symmetric;
  [[nodiscard]] Symmetric symmetric_beside(const BranchEvaluation& near, const PeriodicOrbit& orbit) const;

  /// Largest coordinate of the start, scaled.
  [[nodiscard]] double size(const BranchEvaluation& at) const {
    return stacked(at.at.point.nodes[0]).cwiseQuotient(scale_).cwiseAbs().maxCoeff();
  }
  [[nodiscard]] PeriodicOrbit describe(const BranchEvaluation& at) const;
  /// What describes a point beside its orbit: nothing.
  [[nodiscard]] std::optional<Balance> balance_of(const BranchEvaluation& /*at*/) const { return std::nullopt; }
  /// −Φ(T/2) where solved by half periods, else empty.
  [[nodiscard]] Eigen::MatrixXd half_map(const BranchEvaluation& at) const;
  /// x(T/2) + x(0), scaled [N], where the passes are run in halves; else empty.
  [[nodiscard]] Eigen::VectorXd skew(const BranchEvaluation& at) const;
  /// The unit vector of the parameter [N + e].
  [[nodiscard]] Eigen::VectorXd parameter_row() const;
  [[nodiscard]] double range() const { return range_; }
  [[nodiscard]] const Eigen::VectorXd& scale() const { return scale_; }
  [[nodiscard]] bool half_period() const { return options_.shooting.half_period; }
  [[nodiscard]] bool period_unknown() const { return kind_ == OrbitKind::kSelfExcited; }

 private:
  [[nodiscard]] Eigen::VectorXd newton_step(const BranchEvaluation& at, const BranchUnknowns& guess,
                                            const Eigen::VectorXd& row) const;
  /// The step, or a half, a quarter … of it, that lowers the residual. Where Φ jumps (a stop touched) full steps
  /// alternate between both sides for ever.
  [[nodiscard]] std::optional<BranchEvaluation> shortened(const BranchEvaluation& from,
                                                          const Eigen::VectorXd& step) const;
  void set_times(BranchUnknowns& at, const dynamics::HybridSystem& system) const;
  [[nodiscard]] std::vector<Eigen::MatrixXd> parameter_columns(const BranchUnknowns& at,
                                                               const ShootingEvaluation& here) const;

  dynamics::SystemFamily family_;
  ContinuationOptions options_;
  OrbitKind kind_;
  double range_ = 1.0;
  Eigen::VectorXd scale_;
};

struct BranchSolver::Symmetric {
  BranchSolver solver;
  BranchUnknowns guess;
};

}  // namespace slipmode::orbits
