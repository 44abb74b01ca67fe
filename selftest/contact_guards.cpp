#include "selftest/contact_guards.hpp"

#include <algorithm>
#include <cmath>

namespace slipmode::selftest {
namespace {

using dynamics::ContactMode;

/// (μ cos θ ± sin θ)/(cos θ ∓ μ sin θ), S4 (4.1) in both directions.
double tilted(double mu, double tilt, double sign) {
  const double c = std::cos(tilt), s = sign * std::sin(tilt);
  return (mu * c + s) / (c - mu * s);
}

/// What a law with stick is made of: the coefficient of sliding at the present speed, and the contact spring, 0 if
/// rigid.
struct Sticking {
  double mu_s = 0.0, sliding = 0.0, spring = 0.0;
};

LawCheck check_friction(const friction::Contact& contact, const Sticking& law, ContactMode mode,
                        const ContactInstant& now, const ContactScales& scales) {
  LawCheck result;
  const double N = now.load;
  if (mode == ContactMode::kSeparated) {
    result.guard = -N / scales.force;
    result.law = std::abs(now.lambda) / scales.force;
    return result;
  }
  if (!contact.normal_load.is_constant()) result.guard = N / scales.force;
  if (mode == ContactMode::kStick) {
    const double upper = tilted(law.mu_s, contact.tilt, 1.0) * N - now.lambda;
    const double lower = tilted(law.mu_s, contact.tilt, -1.0) * N + now.lambda;
    const auto told = [&](double left) { return std::copysign(std::max(0.0, std::abs(left) - scales.slack), left); };
    result.guard = std::min({result.guard, told(upper) / scales.force, told(lower) / scales.force});
    if (law.spring == 0.0) result.law = std::abs(now.slip) / scales.speed;
    return result;
  }
  const double sign = mode == ContactMode::kSlipPositive ? 1.0 : -1.0;
  const double coefficient = tilted(law.sliding, contact.tilt, sign);
  result.law = std::abs(now.lambda - sign * coefficient * N) / scales.force;
  // Behind a spring the contact point slides at v_drive − d/dt (y + λ/K).
  const double sliding = now.slip - (law.spring > 0.0 ? sign * coefficient * now.load_rate / law.spring : 0.0);
  result.guard = std::min(result.guard, sign * sliding / scales.speed);
  return result;
}

LawCheck check_smooth(const friction::Law& law, const ContactInstant& now, const ContactScales& scales) {
  const double coefficient = std::copysign(friction::kinetic_coefficient(law, std::abs(now.slip)), now.slip);
  return {.guard = 1.0, .law = std::abs(now.lambda - now.load * coefficient) / scales.force};
}

LawCheck check_bristle(ContactMode mode, const ContactInstant& now, const ContactScales& scales) {
  const double sign = mode == ContactMode::kSlipPositive ? 1.0 : -1.0;
  return {.guard = sign * now.slip / scales.speed, .law = 0.0};
}

/// A stop seen from its own side: `x` its way past the gap, `press` k x + c ẋ. A stop that is not there is never met.
struct Side {
  double x = -1e300, press = -1e300;
};

Side side_of(const std::optional<friction::Stop>& stop, double outward, double rate) {
  if (!stop) return {};
  const double x = outward - stop->gap;
  return {x, stop->stiffness * x + stop->damping * rate};
}

LawCheck check_clearance(const friction::Clearance& law, ContactMode mode, const ContactInstant& now,
                         const ContactScales& scales) {
  const Side left = side_of(law.left, -now.y, -now.v), right = side_of(law.right, now.y, now.v);
  const bool lets_go_at_gap = law.loss == friction::ContactLoss::kGap;
  if (mode == ContactMode::kGap || mode == ContactMode::kLeftFlight || mode == ContactMode::kRightFlight) {
    // Free, and so it stays within the gap, and beyond it where the stop, having let go, would pull. The end of a
    // flight changes no force and is no event.
    const auto free = [&](const Side& side) {
      const double inside = (scales.place - side.x) / scales.way;
      return lets_go_at_gap ? inside : std::max(inside, -side.press / scales.force);
    };
    return {.guard = std::min(free(left), free(right)), .law = std::abs(now.lambda) / scales.force};
  }
  const bool is_left = mode == ContactMode::kLeftStop;
  const Side& side = is_left ? left : right;
  const double guard = lets_go_at_gap ? side.x / scales.way : side.press / scales.force;
  return {.guard = guard, .law = std::abs(now.lambda - (is_left ? 1.0 : -1.0) * side.press) / scales.force};
}

}  // namespace

LawCheck check_law(const friction::Contact& contact, ContactMode mode, const ContactInstant& now,
                   const ContactScales& scales) {
  switch (friction::kind(contact.law)) {
    case friction::LawKind::kClearance:
      return check_clearance(*friction::clearance(contact.law), mode, now, scales);
    case friction::LawKind::kSmooth:
      return check_smooth(contact.law, now, scales);
    case friction::LawKind::kBristle:
      return check_bristle(mode, now, scales);
    default:
      break;
  }
  // Sliding speeds keep the sign of their mode; rounding may not.
  const double speed = (mode == ContactMode::kSlipPositive ? 1.0 : -1.0) * now.slip;
  const Sticking law{.mu_s = friction::static_coefficient(contact.law),
                     .sliding = friction::kinetic_coefficient(contact.law, speed),
                     .spring = friction::spring_stiffness(contact.law)};
  return check_friction(contact, law, mode, now, scales);
}

bool is_idle(const friction::Contact& contact) {
  return friction::contact_forces(contact).kind == friction::LawKind::kFree;
}

}  // namespace slipmode::selftest
