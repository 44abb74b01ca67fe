#pragma once

#include <slipmode/dynamics/system.hpp>
#include <slipmode/friction/contact_forces.hpp>
#include <slipmode/friction/load_form.hpp>

#include <cstdint>
#include <vector>

namespace slipmode::dynamics {

/// What a contact is to the linear equations of a regime.
enum class ContactRole : std::int8_t {
  kSliding,          ///< a constant force, whatever its sign
  kHeld,             ///< sticks: its velocity is the drive's
  kSprung,           ///< sticks behind its contact spring
  kSlidingNegative,  ///< slides with a force proportional to a normal load that varies
  kSlidingPositive,
  kSeparated,  ///< no force; only where the normal load varies
  kGap,        ///< no force, between the stops of a clearance
  kLeftStop,   ///< pressed by the stop's stiffness and damping
  kRightStop,
  kLeftFlight,  ///< no force, beyond the gap of a stop that has let go
  kRightFlight,
};

/// How the force of a contact that is not held answers its own motion, about what is constant:
/// λ = stiffness (d − y) − damping ẏ + friction (z ζ + z_rate ζ̇), y = wᵀq, d the way of the drive where it is followed.
struct ContactAnswer {
  double stiffness = 0.0, damping = 0.0;
  double friction = 0.0;  ///< ±μ_k, sliding under a load that varies
  friction::LoadForm load;
};

[[nodiscard]] ContactAnswer contact_answer(const friction::ContactForces& law, const friction::LoadForm& load,
                                           ContactRole role);

/// What guards a clearance in a mode: sign · (what it measures) + constant > 0, else the mode becomes `next`.
struct StopGuard {
  bool press = false;  ///< measures k (side y − b) + c side ẏ, what a stop presses with, or would; else y
  double sign = 1.0, constant = 0.0;
  ContactMode next = ContactMode::kGap;
};
[[nodiscard]] std::vector<StopGuard> stop_guards(const friction::Clearance& law, ContactMode mode);

/// The stop a clearance is at or beyond in this mode, −1 left, 1 right.
[[nodiscard]] inline double side_of(ContactMode mode) {
  return mode == ContactMode::kLeftStop || mode == ContactMode::kLeftFlight ? -1.0 : 1.0;
}

}  // namespace slipmode::dynamics
