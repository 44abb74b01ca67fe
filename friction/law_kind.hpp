#pragma once

#include <cstdint>

namespace slipmode::friction {

/// What a law is to whoever moves its contact.
enum class LawKind : std::uint8_t {
  kFree,            ///< no force ever: μ N = 0
  kConstant,        ///< rigid stick; the force in slip depends on the normal load alone
  kCompliant,       ///< the same behind a contact spring, whose stretch is a state
  kSpeedDependent,  ///< rigid stick; the force in slip depends on the sliding speed
  kSmooth,          ///< a function of the sliding speed without stick
  kBristle,         ///< no stick; the deflection of bristles is a state, the sign of the sliding speed matters
  kClearance,       ///< stops with play between them, no friction
};

/// Holds its contact on the counterpart, rigidly or by a spring, up to a limit.
[[nodiscard]] constexpr bool sticks(LawKind kind) {
  return kind == LawKind::kConstant || kind == LawKind::kCompliant || kind == LawKind::kSpeedDependent;
}
/// Sticks, and not by a spring.
[[nodiscard]] constexpr bool sticks_rigidly(LawKind kind) { return sticks(kind) && kind != LawKind::kCompliant; }
/// The force is linear between events.
[[nodiscard]] constexpr bool is_piecewise_linear(LawKind kind) {
  return kind == LawKind::kFree || kind == LawKind::kConstant || kind == LawKind::kCompliant ||
         kind == LawKind::kClearance;
}
/// Has a state of its own: a stretch or a deflection.
[[nodiscard]] constexpr bool remembers(LawKind kind) {
  return kind == LawKind::kCompliant || kind == LawKind::kBristle;
}

/// Of a law told by its coefficient at each speed. What holds nothing at rest passes zero as a function of the speed
/// that is odd: no stick, and no event there.
[[nodiscard]] constexpr LawKind kind_by_speed(double mu_s) {
  return mu_s > 0.0 ? LawKind::kSpeedDependent : LawKind::kSmooth;
}

/// Two contacts of these laws may act on one displacement. Of two that stick rigidly the forces could not be told;
/// beside one, springs and bristles would begin to slide and turn where it holds their speed at zero.
[[nodiscard]] constexpr bool can_share_place(LawKind a, LawKind b) {
  const auto apart = [](LawKind rigid, LawKind other) {
    return sticks_rigidly(rigid) && (sticks(other) || other == LawKind::kBristle);
  };
  return !apart(a, b) && !apart(b, a);
}

/// How fast a contact and what it is attached to can move.
struct Pace {
  double load = 0.0;          ///< N [N]
  double mobility = 0.0;      ///< wᵀM⁻¹w [1/kg]
  double speed = 0.0;         ///< [m/s]
  double acceleration = 0.0;  ///< without the contact's force [m/s²]
};

}  // namespace slipmode::friction
