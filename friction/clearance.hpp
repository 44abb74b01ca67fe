#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/friction/law_kind.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

namespace slipmode::friction {

struct ContactForces;

/// One stop of a clearance: beyond the gap it presses with stiffness · (|y| − gap) + damping · d|y|/dt. Contact is at
/// y ≥ gap on the right, y ≤ −gap on the left; a negative gap is a preload.
struct Stop {
  double stiffness = 0.0, damping = 0.0, gap = 0.0;

  static constexpr auto fields() {
    return std::tuple{required("stiffness", &Stop::stiffness, "N/m", "stiffness", kPositive),
                      optional("damping", &Stop::damping, "N s/m", "damping", kNonNegative),
                      required("gap", &Stop::gap, "m", "gap")};
  }

  bool operator==(const Stop&) const = default;
};

/// When a stop lets go.
enum class ContactLoss : std::uint8_t {
  /// Where its force falls to zero: it never pulls. S0. Until y is back at the gap the stop is free and engages again,
  /// without a jump, when k (|y| − b) + c d|y|/dt is positive again.
  kZeroForce,
  /// At the gap, S1 and S2; with damping it pulls on the way out.
  kGap,
};

/// Play between stops (clearance, backlash): no force in the gap, −k (y − b) − c ẏ at the right stop, the mirror image
/// at the left one. A stop that is absent is never met. It has no friction, and the normal load is not read. Source: S0
/// (2.4)-(2.7), S1 (1), S2 (1).
struct Clearance {
  std::optional<Stop> left, right;  ///< at least one
  ContactLoss loss = ContactLoss::kZeroForce;

  static constexpr const char* word = "clearance";
  static constexpr auto fields() {
    return std::tuple{optional("loss", &Clearance::loss, "", "when a stop lets go"),
                      optional("left", &Clearance::left, "", "left stop"),
                      optional("right", &Clearance::right, "", "right stop")};
  }

  [[nodiscard]] LawKind kind() const { return LawKind::kClearance; }
  [[nodiscard]] double static_coefficient() const { return 0.0; }
  [[nodiscard]] double limit_coefficient() const { return 0.0; }
  [[nodiscard]] double kinetic_coefficient(double /*speed*/) const { return 0.0; }
  [[nodiscard]] double fastest_rate(const Pace& pace) const;
  [[nodiscard]] ContactForces forces(double normal_load) const;

  /// Those there are, left first.
  [[nodiscard]] std::vector<Stop> stops() const;
  /// λ at the right stop (side 1) or the left one (−1), 0 in the gap (0). @param y, v  displacement and velocity
  [[nodiscard]] double force(int side, double y, double v) const;
  /// dλ/dt there.
  [[nodiscard]] double force_rate(int side, double v, double acceleration) const;
};

}  // namespace slipmode::friction

namespace slipmode {

template <>
inline constexpr std::array kWords<friction::ContactLoss> = {"zero-force", "gap"};

}  // namespace slipmode
