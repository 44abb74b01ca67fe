#pragma once

#include <slipmode/orbits/branches/continuation.hpp>
#include "orbits/branches/internal/curve_condition.hpp"
#include "orbits/internal/shooting_problem.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::orbits {

/// What continuation solves for.
struct BranchUnknowns {
  ShootingPoint point;
  double parameter = 0.0;
  double phase = 0.0;  ///< of the drive at the origin, as a share of its period; kept as its period changes
  double other = 0.0;  ///< on curves of special points: the parameter that is solved for
  double touch = 0.0;  ///< on curves of grazings: when, as a share of the period after the origin
};

/// A parameter that changes along a branch: where it is kept, its range, and its unit vector among the unknowns.
template <class Unknowns>
struct BranchKey {
  double Unknowns::*value;
  double low, high;
  Eigen::VectorXd row;

  [[nodiscard]] double range() const { return high - low; }
};

/// The parameter as last unknown, before it the other one of a curve. @param last  unit vector of the parameter
template <class Unknowns>
[[nodiscard]] std::vector<BranchKey<Unknowns>> branch_keys(const ContinuationOptions& options,
                                                           const std::optional<CurveCondition>& condition,
                                                           const Eigen::VectorXd& last) {
  const auto key = [](double Unknowns::*value, double from, double to, Eigen::VectorXd row) {
    return BranchKey<Unknowns>{value, std::min(from, to), std::max(from, to), std::move(row)};
  };
  std::vector<BranchKey<Unknowns>> out;
  if (condition)
    out.push_back(key(&Unknowns::other, condition->other.from, condition->other.to,
                      Eigen::VectorXd::Unit(last.size(), last.size() - 2)));
  out.push_back(key(&Unknowns::parameter, options.from, options.to, last));
  return out;
}

/// All keys of a point within their ranges.
template <class Unknowns>
[[nodiscard]] bool is_within(const std::vector<BranchKey<Unknowns>>& keys, const Unknowns& at) {
  return std::ranges::all_of(keys, [&](const BranchKey<Unknowns>& key) {
    const double slack = 1e-12 * key.range(), value = at.*key.value;
    return value >= key.low - slack && value <= key.high + slack;
  });
}

/// A point on (or near) a branch with the linearised conditions there. Scaled unknowns: (x₁ [N], ln T if unknown, on
/// curves the other parameter, p).
struct BranchEvaluation {
  BranchUnknowns at;
  ShootingEvaluation shooting;
  std::shared_ptr<ShootingProblem> problem;
  std::vector<Eigen::MatrixXd> columns;  ///< per segment: of ln T (if unknown) and parameters [N x e]
  Eigen::MatrixXd J;  ///< closing conditions, phase if the period is unknown, and a curve's own condition
  Eigen::VectorXd r;
  double condition = 0.0;  ///< of a curve

  /// What Newton's method lowers, and its largest entry.
  [[nodiscard]] double norm() const { return std::hypot(shooting.norm, condition); }
  [[nodiscard]] double largest() const { return std::max(shooting.largest, std::abs(condition)); }
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
  /// On a curve of special points over (other, parameter).
  /// @param special  with the value of `other`
  /// @throws InvalidInput  for a grazing of no stop
  BranchSolver(dynamics::PlaneFamily family, const SpecialPoint& special, double parameter, const KeyRange& other,
               const ContinuationOptions& options);

  /// @param other  of a curve
  [[nodiscard]] BranchUnknowns unknowns_of(const PeriodicOrbit& orbit, double parameter, double other = 0.0) const;
  [[nodiscard]] BranchUnknowns unknowns_of(const BranchPoint& point) const {
    return unknowns_of(point.orbit, point.parameter, point.other.value_or(0.0));
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

  /// The same family solved for the simpler orbits that a branch is about to join, and the nearest of them as a guess:
  /// for the symmetric ones by half periods at a symmetry breaking, for those of half the period at a period doubling.
  struct Simpler;
  /// @param apart  skew() or halves_apart() of the point
  [[nodiscard]] Simpler simpler_beside(SpecialKind kind, const BranchEvaluation& near, const PeriodicOrbit& orbit,
                                       const Eigen::VectorXd& apart) const;

  /// ẋ at the origin of an orbit whose period is unknown, scaled [N]; else empty.
  [[nodiscard]] Eigen::VectorXd rate(const BranchEvaluation& at) const {
    return period_unknown() ? at.shooting.rate.back() : Eigen::VectorXd{};
  }
  /// Where a state of rest sends off oscillations that neither grow nor decay, and their period.
  struct HopfPoint {
    double parameter = 0.0, period = 0.0;
  };
  /// Of the rest that a small orbit goes round. Nothing where none is found.
  [[nodiscard]] std::optional<HopfPoint> hopf_beside(const BranchEvaluation& near) const;

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
  /// x(T/2) − x(0), scaled [N], of orbits that may have come from a doubling of the period: those of even order, and of
  /// a period that is unknown; else empty.
  [[nodiscard]] Eigen::VectorXd halves_apart(const BranchEvaluation& at) const;
  /// The unit vector of the parameter [N + e].
  [[nodiscard]] Eigen::VectorXd parameter_row() const;
  [[nodiscard]] double range() const { return range_; }
  /// The parameter, and the other one of a curve.
  [[nodiscard]] std::vector<BranchKey<BranchUnknowns>> keys() const;
  [[nodiscard]] bool on_curve() const { return condition_.has_value(); }
  /// Why a curve does not lead on to a point; empty where it does.
  [[nodiscard]] std::string curve_end(const BranchEvaluation& at, const PeriodicOrbit& orbit) const;
  /// The orbit ahead along a tangent, whether or not it is on the curve: what changes where a curve is found no more.
  [[nodiscard]] std::optional<PeriodicOrbit> orbit_ahead(const BranchEvaluation& at, const Eigen::VectorXd& way) const;
  [[nodiscard]] std::optional<double> other_of(const BranchEvaluation& at) const {
    return on_curve() ? std::optional(at.at.other) : std::nullopt;
  }
  [[nodiscard]] const Eigen::VectorXd& scale() const { return scale_; }
  [[nodiscard]] bool half_period() const { return options_.shooting.half_period; }
  [[nodiscard]] bool period_unknown() const { return kind_ == OrbitKind::kSelfExcited; }

 private:
  BranchSolver(dynamics::PlaneFamily family, const PeriodicOrbit& orbit, double parameter, double other,
               const ContinuationOptions& options, const std::optional<CurveCondition>& condition);
  /// A pass: closing conditions by states, period and, if asked, parameters.
  [[nodiscard]] BranchEvaluation closing(const BranchUnknowns& at, bool with_parameters) const;
  void add_condition(BranchEvaluation& out) const;
  /// What vanishes on the curve, as it is measured near a point; may follow the touch of that.
  [[nodiscard]] std::function<double(BranchEvaluation&)> condition_near(const BranchEvaluation& at) const;
  [[nodiscard]] bool in_range(const BranchUnknowns& at) const { return is_within(keys(), at); }
  [[nodiscard]] Eigen::VectorXd newton_step(const BranchEvaluation& at, const BranchUnknowns& guess,
                                            const Eigen::VectorXd& row) const;
  /// The step, or a half, a quarter … of it, that lowers the residual. Where Φ jumps (a stop touched) full steps
  /// alternate between both sides for ever.
  [[nodiscard]] std::optional<BranchEvaluation> shortened(const BranchEvaluation& from,
                                                          const Eigen::VectorXd& step) const;
  void set_times(BranchUnknowns& at, const dynamics::HybridSystem& system) const;
  /// One per segment. @param key  of the unknowns, in keys()
  [[nodiscard]] std::vector<Eigen::VectorXd> parameter_columns(const BranchUnknowns& at, const ShootingEvaluation& here,
                                                               const BranchKey<BranchUnknowns>& key) const;
  [[nodiscard]] dynamics::HybridSystem system_at(const BranchUnknowns& at) const {
    return family_(at.other, at.parameter);
  }

  dynamics::PlaneFamily family_;
  ContinuationOptions options_;
  OrbitKind kind_;
  std::optional<CurveCondition> condition_;
  double range_ = 1.0;
  Eigen::VectorXd scale_;
};

struct BranchSolver::Simpler {
  BranchSolver solver;
  BranchUnknowns guess;
};

}  // namespace slipmode::orbits
