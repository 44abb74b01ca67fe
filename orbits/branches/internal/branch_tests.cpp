#include "orbits/branches/internal/branch_tests.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/floquet.hpp>
#include "orbits/branches/internal/balance_branch_solver.hpp"
#include "orbits/branches/internal/branch_solver.hpp"
#include "orbits/branches/internal/secant.hpp"

#include <fmt/format.h>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace slipmode::orbits {
namespace {

template <class Solver>
using Test = double WatchedPoint<Solver>::*;

constexpr int kMaxEvaluations = 80;
/// Nearer to the unit circle a multiplier cannot be told from one on it.
constexpr double kOnCircle = 1e-10;

/// Multipliers without the trivial ones; of the half-period map where the orbit is symmetric.
std::vector<std::complex<double>> watched_multipliers(const PeriodicOrbit& orbit) {
  std::vector<std::complex<double>> result;
  if (orbit.half_multipliers.size() > 0 && orbit.trivial_multipliers == 0) {
    result.assign(orbit.half_multipliers.begin(), orbit.half_multipliers.end());
    return result;
  }
  const std::vector<Eigen::Index> trivial = trivial_indices(orbit.multipliers, orbit.trivial_multipliers);
  for (Eigen::Index i = 0; i < orbit.multipliers.size(); ++i)
    if (std::find(trivial.begin(), trivial.end(), i) == trivial.end()) result.push_back(orbit.multipliers[i]);
  return result;
}

/// The sign of det [J; tᵀ]; 0 in a family of orbits, where it is rounding.
template <class Solver>
int orientation(const WatchedPoint<Solver>& point) {
  if (point.orbit.family.cols() > 0) return 0;
  Eigen::MatrixXd J(point.at.J.cols(), point.at.J.cols());
  J << point.at.J, point.tangent.transpose();
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(J);
  const auto negative = (lu.matrixLU().diagonal().array() < 0).count();
  return (negative % 2 == 0 ? 1 : -1) * static_cast<int>(lu.permutationP().determinant());
}

/// The multiplier that is critical for a kind, and its distance from criticality.
struct Critical {
  std::complex<double> multiplier;
  double distance = 1.0;
};

Critical critical_multiplier(const PeriodicOrbit& orbit, SpecialKind kind) {
  Critical best{{}, 1e300};
  for (const std::complex<double>& mu : watched_multipliers(orbit)) {
    double distance = 1e300;
    if (kind == SpecialKind::kFold) distance = std::abs(mu - 1.0);
    if (kind == SpecialKind::kSymmetryBreaking || kind == SpecialKind::kPeriodDoubling) distance = std::abs(mu + 1.0);
    if (kind == SpecialKind::kNeimarkSacker && std::abs(mu.imag()) > 1e-6) distance = std::abs(std::abs(mu) - 1.0);
    if (distance < best.distance) best = {mu, distance};
  }
  return best;
}

template <class Solver>
struct Located {
  WatchedPoint<Solver> low, high;  ///< on both sides
  double s = 0.0;                  ///< along a's tangent
};

/// The point a share of the way from the low side to the high one, corrected across a's tangent.
template <class Solver>
std::optional<WatchedPoint<Solver>> between(const Solver& solver, const WatchedPoint<Solver>& a,
                                            const Located<Solver>& sides, double share) {
  const Eigen::VectorXd chord = solver.difference(sides.high.at.at, sides.low.at.at);
  const typename Solver::Unknowns guess = solver.moved(sides.low.at, share * chord, 0.0);
  try {
    auto corrected = solver.correct(guess, a.tangent);
    if (!corrected) return std::nullopt;
    WatchedPoint<Solver> found = watch(solver, solver.polished(std::move(corrected->at), guess, a.tangent), a.tangent);
    keep_orientation(a, found);
    return found;
  } catch (const NumericalFailure&) {
    return std::nullopt;  // the flow fails there: beside it it may not
  }
}

/// Narrows [low at s = 0, high at s] until the sides are the same to rounding or the parameter is known.
/// `value` must have opposite signs at both; steps by Illinois' rule where it is smooth, else halves.
template <class Solver>
Located<Solver> narrow(const Solver& solver, const WatchedPoint<Solver>& a, const WatchedPoint<Solver>& b, double s,
                       double tolerance, const std::function<double(const WatchedPoint<Solver>&)>& value, bool smooth) {
  Located<Solver> found{a, b, s};
  double low = 0.0, high = s, at_low = value(a), at_high = value(b);
  for (int k = 0; k < kMaxEvaluations; ++k) {
    const double apart = std::abs(found.high.at.at.parameter - found.low.at.at.parameter);
    if ((apart <= tolerance && high - low <= 1e-6) || high - low <= 1e-12) break;
    double middle = 0.5 * (low + high);
    if (smooth && k % 4 != 3) {
      const double secant = low - at_low * (high - low) / (at_high - at_low);
      const double margin = 1e-3 * (high - low);
      middle = std::clamp(secant, low + margin, high - margin);
    }
    std::optional<WatchedPoint<Solver>> next;
    for (const double at : {middle, low + 0.5 * (high - low), low + 0.2 * (high - low), low + 0.8 * (high - low)}) {
      next = between(solver, a, found, (at - low) / (high - low));
      middle = at;
      if (next) break;
    }
    if (!next) break;
    const double here = value(*next);
    if ((here < 0) == (at_low < 0)) {
      low = middle, at_low = here, found.low = std::move(*next);
      at_high *= 0.5;
    } else {
      high = middle, at_high = here, found.high = std::move(*next);
      at_low *= 0.5;
    }
  }
  found.s = 0.5 * (low + high);
  return found;
}

template <class Solver>
Eigen::VectorXd critical_direction(const WatchedPoint<Solver>& point, SpecialKind kind,
                                   std::complex<double> multiplier) {
  const bool half = kind == SpecialKind::kSymmetryBreaking && point.half_map.size() > 0;
  const Eigen::MatrixXd& matrix = half ? point.half_map : point.orbit.monodromy;
  if (matrix.size() == 0) return {};
  const std::vector<FloquetMode> modes = floquet_modes(matrix);
  const auto nearest = std::min_element(modes.begin(), modes.end(), [&](const FloquetMode& x, const FloquetMode& y) {
    return std::abs(x.multiplier - multiplier) < std::abs(y.multiplier - multiplier);
  });
  return nearest->direction.real();
}

template <class Solver>
SpecialPoint special_of(const Solver& solver, const Located<Solver>& found, SpecialKind kind, double tolerance) {
  SpecialPoint out;
  const WatchedPoint<Solver>& nearest = found.low;
  out.kind = kind;
  out.parameter = 0.5 * (found.low.at.at.parameter + found.high.at.at.parameter);
  out.uncertainty = std::abs(found.high.at.at.parameter - found.low.at.at.parameter);
  out.orbit = nearest.orbit;
  out.balance = nearest.balance;
  out.other = solver.other_of(nearest.at);
  if (out.uncertainty > tolerance)
    out.note = fmt::format("located to {:.1e} only: the branch is not found nearer. ", out.uncertainty);
  return out;
}

/// The corner in which two pieces of a branch end, where both have orbits on the same side of it: pieces are found
/// beside each other before it, and their tangents meet in it.
template <class Solver>
SpecialPoint corner_of(const Solver& solver, const Located<Solver>& found, double tolerance) {
  SpecialPoint out = special_of(solver, found, SpecialKind::kNonSmoothFold, std::numeric_limits<double>::infinity());
  const Eigen::VectorXd apart = solver.difference(found.high.at.at, found.low.at.at);
  Eigen::MatrixXd ways(apart.size(), 2);
  ways << found.low.tangent, -found.high.tangent;
  const Eigen::Vector2d lengths = ways.colPivHouseholderQr().solve(apart);
  const double by_low = found.low.at.at.parameter + lengths[0] * found.low.fold * solver.range();
  const double by_high = found.high.at.at.parameter + lengths[1] * found.high.fold * solver.range();
  const double left = (ways * lengths - apart).norm() + lengths.squaredNorm();  // what lines miss, and curves leave
  out.parameter = 0.5 * (by_low + by_high);
  out.uncertainty = std::abs(by_high - by_low) + left * solver.range();
  if (out.uncertainty > tolerance) out.note = fmt::format("located to {:.1e} only. ", out.uncertainty);
  out.note += word_change(found.low.orbit, found.high.orbit);
  return out;
}

struct Found {
  double s;
  SpecialPoint point;
};

template <class Solver>
void add_smooth(const Solver& solver, const WatchedPoint<Solver>& a, const WatchedPoint<Solver>& b, double s,
                double tolerance, SpecialKind kind, Test<Solver> test, std::vector<Found>& out_found) {
  if ((a.*test < 0) == (b.*test < 0)) return;
  // Where nothing is lost a pair is on the circle all along: which side of it is rounding.
  if (kind == SpecialKind::kNeimarkSacker && critical_multiplier(a.orbit, kind).distance < kOnCircle &&
      critical_multiplier(b.orbit, kind).distance < kOnCircle)
    return;
  const Located<Solver> at = narrow<Solver>(
      solver, a, b, s, tolerance, [&](const WatchedPoint<Solver>& p) { return p.*test; }, true);
  Critical critical = critical_multiplier(at.low.orbit, kind);
  const Critical other = critical_multiplier(at.high.orbit, kind);
  if (other.distance < critical.distance) critical = other;
  // None passes: truncation hands a balance's multipliers from one choice to another.
  if (kind != SpecialKind::kFold && critical.distance > 0.1) return;
  const bool jumps = at.low.orbit.word != at.high.orbit.word;
  if (kind == SpecialKind::kNeimarkSacker && critical.distance > 1e-4) return;  // two real ones of product 1
  SpecialPoint special = special_of(solver, at, kind, tolerance);
  if (jumps && critical.distance > 1e-3) {
    if (kind != SpecialKind::kFold) return;  // the multiplier jumps with the word, which is reported as such
    special = corner_of(solver, at, tolerance);
  } else {
    special.multiplier = critical.multiplier;
    special.direction = critical_direction(at.low, kind, critical.multiplier);
  }
  out_found.push_back({at.s, std::move(special)});
}

/// A simpler branch that orbits may join: symmetric ones (seen from the asymmetric side of a pitchfork), those of half
/// the period, or a state of rest. Beyond, the orbits are the same ones again: mirror images, or half a period later.
template <class Solver>
struct Joining {
  SpecialKind kind;
  Eigen::VectorXd WatchedPoint<Solver>::*apart;  ///< what passes through zero
};

template <class Solver>
std::optional<Joining<Solver>> joining_between(const WatchedPoint<Solver>& a, const WatchedPoint<Solver>& b) {
  using Point = WatchedPoint<Solver>;
  for (const Joining<Solver>& to : {Joining<Solver>{SpecialKind::kHopf, &Point::rate},
                                    Joining<Solver>{SpecialKind::kPeriodDoubling, &Point::halves},
                                    Joining<Solver>{SpecialKind::kSymmetryBreaking, &Point::skew}}) {
    const Eigen::VectorXd &before = a.*to.apart, &after = b.*to.apart;
    const bool joined = to.kind == SpecialKind::kSymmetryBreaking && (a.orbit.symmetric || b.orbit.symmetric);
    if (before.size() > 0 && before.size() == after.size() && before.dot(after) < 0 && !joined) return to;
  }
  return std::nullopt;
}

/// Where the simpler orbits beside one that nearly joined them lose what makes them so, by secants on a test function:
/// regular, where the joining branch is not.
template <class Solver>
std::optional<WatchedPoint<Solver>> loss_beside(const Solver& solver, SpecialKind kind,
                                                const WatchedPoint<Solver>& near) {
  const Test<Solver> test =
      kind == SpecialKind::kPeriodDoubling ? &WatchedPoint<Solver>::doubling : &WatchedPoint<Solver>::breaking;
  const Eigen::VectorXd& apart = kind == SpecialKind::kPeriodDoubling ? near.halves : near.skew;
  const auto simpler = solver.simpler_beside(kind, near.at, near.orbit, apart);
  std::optional<WatchedPoint<Solver>> found;
  const auto loss_at = [&](double parameter) -> std::optional<double> {
    typename Solver::Unknowns guess = simpler.guess;
    guess.parameter = parameter;
    const auto corrected = simpler.solver.correct(guess, simpler.solver.parameter_row());
    if (!corrected) return std::nullopt;
    found = watch(simpler.solver, corrected->at, simpler.solver.parameter_row());
    return (*found).*test;
  };
  const double start = near.at.at.parameter, reach = 1e-2 * solver.range();
  return secant_root(loss_at, start, start + 1e-3 * reach, 1e-12 * solver.range(), reach) ? found : std::nullopt;
}

/// The point itself by the simpler branch, as ever nearer orbits of the joining one are found ever worse.
template <class Solver>
void tell_by_the_simpler(const Solver& solver, const WatchedPoint<Solver>& near, SpecialPoint& out_special) {
  const double uncertainty = 1e-12 * solver.range();
  if (out_special.kind == SpecialKind::kHopf) {
    if constexpr (Solver::kByShooting) {
      const auto rest = solver.hopf_beside(near.at);
      if (!rest) return;
      out_special.parameter = rest->parameter;
      out_special.uncertainty = uncertainty;
      out_special.note = fmt::format("orbits of period {:.9g} shrink to rest", rest->period);
    }
    return;
  }
  const bool doubled = out_special.kind == SpecialKind::kPeriodDoubling;
  if (const auto exact = loss_beside(solver, out_special.kind, near)) {
    out_special.parameter = exact->at.at.parameter;
    out_special.uncertainty = uncertainty;
    out_special.orbit = exact->orbit;
    out_special.balance = exact->balance;
    out_special.multiplier = critical_multiplier(exact->orbit, out_special.kind).multiplier;
    out_special.direction = critical_direction(*exact, out_special.kind, out_special.multiplier);
    out_special.note.clear();
  }
  out_special.note += doubled ? "reached from the doubled side" : "reached from the asymmetric side";
}

template <class Solver>
SpecialPoint joining_point(const Solver& solver, const WatchedPoint<Solver>& a, const WatchedPoint<Solver>& b, double s,
                           double tolerance, const Joining<Solver>& to, WatchedPoint<Solver>& out_last) {
  Located<Solver> at = narrow<Solver>(
      solver, a, b, s, tolerance, [&](const WatchedPoint<Solver>& p) { return (p.*to.apart).dot(a.*to.apart); }, true);
  SpecialPoint special = special_of(solver, at, to.kind, tolerance);
  tell_by_the_simpler(solver, at.low, special);
  out_last = std::move(at.low);
  return special;
}

/// How a curve's projection on the plane of its parameters goes, seen from a direction in that.
template <class Solver>
double onward(const Solver& solver, const WatchedPoint<Solver>& point, const WatchedPoint<Solver>& seen_from) {
  double sum = 0.0;
  for (const auto& key : solver.keys()) sum += key.row.dot(point.tangent) * key.row.dot(seen_from.tangent);
  return sum;
}

/// At a cusp the curve goes on among orbits and turns back in the plane.
template <class Solver>
void add_cusp(const Solver& solver, const WatchedPoint<Solver>& a, const WatchedPoint<Solver>& b, double s,
              double tolerance, std::vector<Found>& out_found) {
  if (onward(solver, b, a) >= 0.0) return;
  const Located<Solver> at = narrow<Solver>(
      solver, a, b, s, tolerance, [&](const WatchedPoint<Solver>& p) { return onward(solver, p, a); }, true);
  out_found.push_back({at.s, special_of(solver, at, SpecialKind::kCusp, tolerance)});
}

/// What each contact goes through in a word: its letters, without those during which only others change.
std::vector<std::string> each_contacts_own(const std::string& word) {
  std::vector<std::string> result(std::min(word.find(' '), word.size()));
  for (std::size_t at = 0; at < word.size(); at += result.size() + 1)
    for (std::size_t c = 0; c < result.size(); ++c)
      if (!result[c].ends_with(word[at + c])) result[c] += word[at + c];
  for (std::string& letters : result)
    if (letters.size() > 1 && letters.front() == letters.back()) letters.pop_back();
  return result;
}

/// How often a contact comes to a letter over a period; −1 where it never leaves it.
std::ptrdiff_t visits(const std::string& own, char letter) {
  return own.size() == 1 && own[0] == letter ? -1 : std::count(own.begin(), own.end(), letter);
}

}  // namespace

std::string word_change(const PeriodicOrbit& before, const PeriodicOrbit& after) {
  return fmt::format("word \"{}\" before ({} crossings), \"{}\" after ({})", abridged(before.word), before.crossings,
                     abridged(after.word), after.crossings);
}

SpecialKind kind_of_word_change(const std::string& before, const std::string& after) {
  const std::vector<std::string> a = each_contacts_own(before), b = each_contacts_own(after);
  const auto differ_in = [&](char letter) {
    return !std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const std::string& x, const std::string& y) {
      return visits(x, letter) == visits(y, letter);
    });
  };
  if (differ_in('0')) return SpecialKind::kStickChange;
  for (const char letter : {'l', 'r', 'g', 'x'})
    if (differ_in(letter)) return SpecialKind::kGrazing;
  return SpecialKind::kWordChange;
}

template <class Solver>
WatchedPoint<Solver> watch(const Solver& solver, typename Solver::Evaluation at, const Eigen::VectorXd& along) {
  WatchedPoint<Solver> out;
  out.orbit = solver.describe(at);
  out.balance = solver.balance_of(at);
  out.tangent = solver.tangent(at, along);
  out.half_map = solver.half_map(at);
  out.skew = solver.skew(at);
  if constexpr (Solver::kByShooting) {
    out.halves = solver.halves_apart(at);
    out.rate = solver.rate(at);
  }
  out.at = std::move(at);
  out.fold = solver.parameter_row().dot(out.tangent);
  const std::vector<std::complex<double>> multipliers = watched_multipliers(out.orbit);
  std::complex<double> plus = 1.0, pairs = 1.0;
  for (std::size_t i = 0; i < multipliers.size(); ++i) {
    plus *= 1.0 + multipliers[i];
    for (std::size_t j = 0; j < i; ++j) pairs *= 1.0 - multipliers[i] * multipliers[j];
  }
  const bool halves = out.orbit.half_multipliers.size() > 0 && out.orbit.trivial_multipliers == 0;
  (halves ? out.breaking : out.doubling) = plus.real();
  out.torus = pairs.real();
  return out;
}

template <class Solver>
void keep_orientation(const WatchedPoint<Solver>& last, WatchedPoint<Solver>& out_point) {
  if (out_point.orbit.word == last.orbit.word || orientation(out_point) * orientation(last) >= 0) return;
  out_point.tangent = -out_point.tangent;
  out_point.fold = -out_point.fold;
}

template <class Solver>
SpecialPoints<Solver> special_points_between(const Solver& solver, const WatchedPoint<Solver>& a,
                                             const WatchedPoint<Solver>& b, double s, double tolerance) {
  using Point = WatchedPoint<Solver>;
  if (const auto to = solver.on_curve() ? std::nullopt : joining_between(a, b)) {
    WatchedPoint<Solver> last;
    SpecialPoint point = joining_point(solver, a, b, s, tolerance, *to, last);
    return {{std::move(point)}, std::move(last)};
  }
  std::vector<Found> found;
  if (solver.on_curve()) {
    add_cusp(solver, a, b, s, tolerance, found);
  } else {
    add_smooth(solver, a, b, s, tolerance, SpecialKind::kFold, &Point::fold, found);
  }
  const bool same_symmetry = a.orbit.symmetric == b.orbit.symmetric;
  if (same_symmetry && !solver.on_curve()) {
    add_smooth(solver, a, b, s, tolerance, SpecialKind::kSymmetryBreaking, &Point::breaking, found);
    add_smooth(solver, a, b, s, tolerance, SpecialKind::kPeriodDoubling, &Point::doubling, found);
    add_smooth(solver, a, b, s, tolerance, SpecialKind::kNeimarkSacker, &Point::torus, found);
  }
  const bool turns_back =
      std::ranges::any_of(found, [](const Found& one) { return one.point.kind == SpecialKind::kNonSmoothFold; });
  if (a.orbit.word != b.orbit.word && !turns_back) {
    const Located<Solver> at = narrow<Solver>(
        solver, a, b, s, tolerance, [&](const Point& p) { return p.orbit.word == a.orbit.word ? -1.0 : 1.0; }, false);
    SpecialPoint special =
        special_of(solver, at, kind_of_word_change(at.low.orbit.word, at.high.orbit.word), tolerance);
    special.note += word_change(at.low.orbit, at.high.orbit);
    found.push_back({at.s, std::move(special)});
  }
  std::stable_sort(found.begin(), found.end(), [](const Found& x, const Found& y) { return x.s < y.s; });
  SpecialPoints<Solver> out;
  for (Found& one : found) out.points.push_back(std::move(one.point));
  return out;
}

template WatchedPoint<BranchSolver> watch(const BranchSolver&, BranchEvaluation, const Eigen::VectorXd&);
template void keep_orientation(const WatchedPoint<BranchSolver>&, WatchedPoint<BranchSolver>&);
template SpecialPoints<BranchSolver> special_points_between(const BranchSolver&, const WatchedPoint<BranchSolver>&,
                                                            const WatchedPoint<BranchSolver>&, double, double);
template WatchedPoint<BalanceBranchSolver> watch(const BalanceBranchSolver&, BalanceBranchEvaluation,
                                                 const Eigen::VectorXd&);
template void keep_orientation(const WatchedPoint<BalanceBranchSolver>&, WatchedPoint<BalanceBranchSolver>&);
template SpecialPoints<BalanceBranchSolver> special_points_between(const BalanceBranchSolver&,
                                                                   const WatchedPoint<BalanceBranchSolver>&,
                                                                   const WatchedPoint<BalanceBranchSolver>&, double,
                                                                   double);

}  // namespace slipmode::orbits
