#pragma once

#include <slipmode/orbits/continuation.hpp>
#include "orbits/balance/internal/balance_problem.hpp"
#include "orbits/internal/branch_solver.hpp"

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

namespace slipmode::orbits {

/// What continuation of balances solves for: as BalanceProblem's unknowns.
struct BalanceUnknowns {
  Eigen::VectorXd x;
  double parameter = 0.0;
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
/// in units of the first point's largest, the parameter in units of its range.
struct BalanceBranchEvaluation {
  BalanceUnknowns at;
  std::shared_ptr<const BalanceAt> own;
  BalanceEvaluation balance;
  Eigen::MatrixXd J;  ///< [N x N+1]
  Eigen::VectorXd r;  ///< [N]
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
  /// b − a, scaled [N + 1].
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
  [[nodiscard]] bool on_curve() const { return false; }
  [[nodiscard]] std::optional<PeriodicOrbit> orbit_ahead(const BalanceBranchEvaluation& /*at*/,
                                                         const Eigen::VectorXd& /*way*/) const {
    return std::nullopt;
  }
  [[nodiscard]] std::string curve_end(const BalanceBranchEvaluation& /*at*/, const PeriodicOrbit& /*orbit*/) const {
    return {};
  }
  [[nodiscard]] std::optional<double> other_of(const BalanceBranchEvaluation& /*at*/) const { return std::nullopt; }

 private:
  [[nodiscard]] Eigen::VectorXd newton_step(const BalanceBranchEvaluation& at, const BalanceUnknowns& guess,
                                            const Eigen::VectorXd& row) const;
  void clear_even(Eigen::VectorXd& x) const;
  /// The orders solved for, in units of the size; equilibria as the displacements that the stiffest stop has under
  /// them.
  [[nodiscard]] Eigen::VectorXd scaled(const Eigen::VectorXd& column) const;

  dynamics::SystemFamily family_;
  ContinuationOptions options_;
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
