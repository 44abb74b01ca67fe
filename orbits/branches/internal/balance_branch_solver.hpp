#pragma once

#include <slipmode/orbits/branches/continuation.hpp>
#include "orbits/balance/internal/balance_problem.hpp"
#include "orbits/branches/internal/branch_solver.hpp"

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace slipmode::orbits {

/// What continuation of balances solves for: as BalanceProblem's unknowns.
struct BalanceUnknowns {
  Eigen::VectorXd x;
  double parameter = 0.0;
  double other = 0.0;  ///< on curves of special points: the parameter that is solved for
  double touch = 0.0;  ///< on curves of grazings: when, as a share of the period
};

/// A system's equations of balance, kept together.
struct BalanceAt {
  dynamics::HybridSystem system;
  ContactResponse response;
  BalanceProblem problem;

  BalanceAt(dynamics::HybridSystem own, int order, int harmonics);
  BalanceAt(const BalanceAt&) = delete;
  BalanceAt& operator=(const BalanceAt&) = delete;
};

/// A point on (or near) a branch with the linearised equations there, in scaled unknowns: displacements' coefficients
/// in units of the first point's largest, on curves the other parameter, and the parameter in units of their ranges.
struct BalanceBranchEvaluation {
  BalanceUnknowns at;
  std::shared_ptr<const BalanceAt> own;
  BalanceEvaluation balance;
  Eigen::MatrixXd J;  ///< [N x N+1], on curves [N+1 x N+2]
  Eigen::VectorXd r;  ///< [N], [N+1]
};

/// Predictor and corrector of a branch of balances: what BranchSolver is for orbits. For one thread.
///
/// A balance that is symmetric stays so: its odd orders alone are solved for, which is regular where the symmetry
/// breaks.
class BalanceBranchSolver {
 public:
  using Unknowns = BalanceUnknowns;
  using Evaluation = BalanceBranchEvaluation;
  static constexpr bool kByShooting = false;

  /// @param from       a balance at its parameter
  /// @param symmetric  odd orders alone
  BalanceBranchSolver(dynamics::SystemFamily family, const Balance& from, double parameter,
                      const ContinuationOptions& options, bool symmetric);
  /// On a curve of special points over (other, parameter).
  /// @param special  with its balance, at the value of `other`
  /// @throws InvalidInput  for a grazing of no stop
  BalanceBranchSolver(dynamics::PlaneFamily family, const SpecialPoint& special, double parameter,
                      const KeyRange& other, const ContinuationOptions& options);

  [[nodiscard]] BalanceUnknowns unknowns_of(const BranchPoint& point) const;
  /// Largest coefficient [m].
  [[nodiscard]] double size(const BalanceBranchEvaluation& at) const { return at.at.x.cwiseAbs().maxCoeff(); }
  /// @throws NumericalFailure  outside the range; InvalidInput when the family refuses
  [[nodiscard]] BalanceBranchEvaluation evaluate(const BalanceUnknowns& at) const;
  /// Unit vector along the branch, with a positive product with `along`.
  [[nodiscard]] Eigen::VectorXd tangent(const BalanceBranchEvaluation& at, const Eigen::VectorXd& along) const;
  [[nodiscard]] BalanceUnknowns moved(const BalanceBranchEvaluation& from, const Eigen::VectorXd& step,
                                      double share) const;

  struct Corrected {
    BalanceBranchEvaluation at;
    int iterations = 0;
  };
  /// Newton from `guess` with row · (unknowns − guess) = 0 as the last condition; nothing when it does not converge.
  [[nodiscard]] std::optional<Corrected> correct(const BalanceUnknowns& guess, const Eigen::VectorXd& row) const;
  /// One more step, kept if it lowers the residual.
  [[nodiscard]] BalanceBranchEvaluation polished(BalanceBranchEvaluation at, const BalanceUnknowns& guess,
                                                 const Eigen::VectorXd& row) const;
  /// b − a, scaled [J.cols()].
  [[nodiscard]] Eigen::VectorXd difference(const BalanceUnknowns& b, const BalanceUnknowns& a) const;

  [[nodiscard]] PeriodicOrbit describe(const BalanceBranchEvaluation& at) const;
  [[nodiscard]] std::optional<Balance> balance_of(const BalanceBranchEvaluation& at) const;
  /// Maps are not at hand, only their eigenvalues.
  [[nodiscard]] Eigen::MatrixXd half_map(const BalanceBranchEvaluation& /*at*/) const { return {}; }
  /// The even orders where the system is its own mirror image and they are unknown; else empty.
  [[nodiscard]] Eigen::VectorXd skew(const BalanceBranchEvaluation& at) const;
  /// The family's odd orders alone, and what they are at a point.
  struct Simpler;
  [[nodiscard]] Simpler simpler_beside(SpecialKind kind, const BalanceBranchEvaluation& near,
                                       const PeriodicOrbit& orbit, const Eigen::VectorXd& apart) const;

  [[nodiscard]] Eigen::VectorXd parameter_row() const;
  [[nodiscard]] double range() const { return range_; }
  [[nodiscard]] std::vector<BranchKey<BalanceUnknowns>> keys() const;
  [[nodiscard]] bool on_curve() const { return condition_.has_value(); }
  [[nodiscard]] std::optional<PeriodicOrbit> orbit_ahead(const BalanceBranchEvaluation& /*at*/,
                                                         const Eigen::VectorXd& /*way*/) const {
    return std::nullopt;
  }
  /// Why a curve does not lead on to a point; empty where it does.
  [[nodiscard]] std::string curve_end(const BalanceBranchEvaluation& at, const PeriodicOrbit& orbit) const;
  [[nodiscard]] std::optional<double> other_of(const BalanceBranchEvaluation& at) const {
    return on_curve() ? std::optional(at.at.other) : std::nullopt;
  }

 private:
  BalanceBranchSolver(dynamics::PlaneFamily family, const Balance& from, double parameter, double other,
                      const ContinuationOptions& options, bool symmetric,
                      const std::optional<CurveCondition>& condition);
  /// The equations and their derivatives by the unknowns and, if asked, the parameters.
  [[nodiscard]] BalanceBranchEvaluation balanced(const BalanceUnknowns& at, bool with_parameters) const;
  /// By a parameter of the unknowns, in keys().
  [[nodiscard]] Eigen::VectorXd parameter_column(const BalanceUnknowns& at,
                                                 const BranchKey<BalanceUnknowns>& key) const;
  [[nodiscard]] bool in_range(const BalanceUnknowns& at) const { return is_within(keys(), at); }
  void add_condition(BalanceBranchEvaluation& out) const;
  /// What vanishes on the curve, as it is measured near a point; may follow the touch of that.
  [[nodiscard]] std::function<double(BalanceBranchEvaluation&)> condition_near(const BalanceBranchEvaluation& at) const;
  /// That of even orders, which is singular where the odd ones lose their symmetry.
  [[nodiscard]] Eigen::MatrixXd even_block(const BalanceBranchEvaluation& at) const;
  /// Of half a period where the balance is symmetric.
  [[nodiscard]] Eigen::VectorXcd multipliers_at(const BalanceBranchEvaluation& at) const;
  [[nodiscard]] std::shared_ptr<const BalanceAt> equations_at(const BalanceUnknowns& at) const {
    return std::make_shared<const BalanceAt>(family_(at.other, at.parameter), first_.order, first_.harmonics);
  }
  [[nodiscard]] Eigen::VectorXd newton_step(const BalanceBranchEvaluation& at, const BalanceUnknowns& guess,
                                            const Eigen::VectorXd& row) const;
  void clear_even(Eigen::VectorXd& x) const;
  /// Entries of a column, in units of the size; equilibria as the displacements that the stiffest stop has under them.
  [[nodiscard]] Eigen::VectorXd scaled(const Eigen::VectorXd& column, const std::vector<Eigen::Index>& entries) const;
  [[nodiscard]] Eigen::MatrixXd scaled_block(const Eigen::MatrixXd& jacobian,
                                             const std::vector<Eigen::Index>& entries) const;

  dynamics::PlaneFamily family_;
  ContinuationOptions options_;
  std::optional<CurveCondition> condition_;
  Balance first_;  ///< order, harmonics, family
  bool symmetric_;
  double range_ = 1.0, size_ = 1.0, stiffness_ = 0.0;
  Eigen::Index displacements_ = 0;           ///< so many unknowns first; forces balance the others
  std::vector<Eigen::Index> solved_, even_;  ///< entries of x: those that are unknown, and those of even order
};

struct BalanceBranchSolver::Simpler {
  BalanceBranchSolver solver;
  BalanceUnknowns guess;
};

}  // namespace slipmode::orbits
