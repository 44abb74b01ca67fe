#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/branches/balance_branch.hpp>
#include <slipmode/orbits/branches/special_curve.hpp>
#include "special_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <optional>
#include <string>

namespace slipmode::orbits {

/// What curves over frequency and amplitude leave.
struct CurveStart {
  dynamics::PlaneFamily family;
  double amplitude;
  Branch branch;  ///< over the frequency, at this amplitude
};

[[nodiscard]] inline Branch curve_from(const CurveStart& start, const SpecialPoint& special, double low, double high) {
  return continue_special(start.family, special, start.amplitude, {0.05, 3.0}, {.from = low, .to = high});
}

template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
    return "none";
  } catch (const InvalidInput& refused) {
    return refused.what();
  }
}

/// A period doubling elsewhere than on the curve, and taken for what cannot be followed. @param start  of two masses
inline void expect_refusals(const CurveStart& start) {
  const auto refusal = [&](const SpecialPoint& special, const KeyRange& over) {
    return message_of([&] {
      static_cast<void>(continue_special(start.family, special, start.amplitude, over, {.from = 0.05, .to = 0.2}));
    });
  };
  SpecialPoint point = of_kind(start.branch, SpecialKind::kPeriodDoubling).at(0);
  EXPECT_THAT(refusal(point, {0.5, 0.6}), testing::HasSubstr("outside its range"));
  point.kind = SpecialKind::kGrazing;
  EXPECT_THAT(refusal(point, {0.5, 0.8}), testing::HasSubstr("just reaches a stop"));
  point.kind = SpecialKind::kStickChange;
  EXPECT_THAT(refusal(point, {0.5, 0.8}), testing::HasSubstr("followed over two keys are"));
}

/// A balance beside a curve's point, by Newton's method or, where that misses it as beside folds, some steps along the
/// branch.
[[nodiscard]] inline std::optional<BranchPoint> balance_beside(const dynamics::SystemFamily& over,
                                                               const BranchPoint& point, double omega,
                                                               ContinuationOptions options) {
  const Balance& own = *point.balance;
  const Balance cold =
      balance(over(omega), {.order = own.order, .harmonics = own.harmonics, .guess = own.displacement});
  if (cold.converged) return BranchPoint{.parameter = omega, .orbit = {}, .balance = cold};
  options.direction = omega > *point.other ? 1 : -1;
  options.both_ways = false;
  options.max_points = 5;
  const Branch few = continue_balance(over, own, *point.other, options);
  return few.points.empty() ? std::nullopt : std::optional(few.points.back());
}

/// A branch over the frequency alone that begins beside a curve's point. Nothing where none is found there.
[[nodiscard]] inline std::optional<Branch> branch_beside(const dynamics::SystemFamily& over, const BranchPoint& point,
                                                         double omega, const ContinuationOptions& options) {
  if (point.balance) {
    const std::optional<BranchPoint> first = balance_beside(over, point, omega, options);
    if (!first) return std::nullopt;
    return continue_balance(over, *first->balance, first->parameter, options);
  }
  const bool driven = point.orbit.kind == OrbitKind::kDriven;
  const ShootingResult found = shoot(
      over(omega), point.orbit.start,
      {.order = point.orbit.order, .period = driven ? 0.0 : point.orbit.period, .half_period = point.orbit.symmetric});
  if (!found.converged()) return std::nullopt;
  return continue_orbit(over, found.orbit, omega, options);
}

/// The frequency of the nearest special point of a branch over the frequency alone, at a curve point's amplitude.
[[nodiscard]] inline std::optional<double> found_alone(const dynamics::PlaneFamily& family, const BranchPoint& point,
                                                       SpecialKind kind, double reach) {
  const double omega = *point.other;
  std::optional<double> nearest;
  for (const double share : {0.3, -0.3}) {
    const std::optional<Branch> branch =
        branch_beside(at_amplitude(family, point.parameter), point, omega + share * reach,
                      {.from = omega - reach, .to = omega + reach, .both_ways = true, .max_points = 200});
    if (!branch) continue;
    for (const SpecialPoint& special : of_kind(*branch, kind))
      if (!nearest || std::abs(special.parameter - omega) < std::abs(*nearest - omega)) nearest = special.parameter;
    if (nearest && point.balance) break;  // the exponents of every point take their time
  }
  return nearest;
}

/// About twenty points of a curve, of amplitudes from `least` on, beside what is found alone.
inline void expect_found_alone(const CurveStart& start, const Branch& curve, SpecialKind kind, double reach,
                               double least = 0.0) {
  ASSERT_GT(curve.points.size(), 20U);
  const std::size_t every = curve.points.size() / 20;
  for (std::size_t k = every / 2; k < curve.points.size(); k += every) {
    const BranchPoint& point = curve.points[k];
    if (point.parameter < least) continue;
    const std::optional<double> alone = found_alone(start.family, point, kind, reach);
    ASSERT_TRUE(alone) << "at " << *point.other << ", " << point.parameter;
    EXPECT_NEAR(*point.other, *alone, 1e-8) << "at amplitude " << point.parameter;
  }
}

}  // namespace slipmode::orbits
