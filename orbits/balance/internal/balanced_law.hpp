#pragma once

#include <slipmode/friction/contact.hpp>
#include "orbits/balance/internal/clearance_balance.hpp"
#include "orbits/balance/internal/jenkins_balance.hpp"
#include "orbits/balance/internal/smooth_balance.hpp"

#include <variant>

namespace slipmode::orbits {

/// The laws that balance holds. Each is a struct with its numbers and
///
///     kRemembers                       the force depends on the motion before, too
///     kFollowsDrive                    y is seen from the counterpart: less the displacement of a shaker
///     at_share(share)                  the law on the way from a linear one, share → 0, to its own, 1
///     force(y, omega, samples, orders) Fourier coefficients along y, and their derivatives
///     passage(y, omega)                what the contact does over a period
///     impedance(omega)                 −λ/y of the linear law at share 0, at this frequency
///     strongest(omega)                 largest |−∂λ/∂y| there is, at this frequency
///
/// A law with a state of its own has it told by `own_state`, one without memory its answers to neighbours by `tangent`.
using BalancedLaw = std::variant<BalancedClearance, BalancedJenkins, BalancedSmooth>;

/// @param c  the contact's number, for the message
/// @throws InvalidInput  for a law, load or coefficients that balance does not hold, with the key and what to do
/// instead
[[nodiscard]] BalancedLaw balanced_law(const friction::Contact& contact, std::size_t c);

[[nodiscard]] inline bool remembers(const BalancedLaw& law) {
  return std::visit([](const auto& own) { return own.kRemembers; }, law);
}
[[nodiscard]] inline bool follows_drive(const BalancedLaw& law) {
  return std::visit([](const auto& own) { return own.kFollowsDrive; }, law);
}
[[nodiscard]] inline BalancedLaw at_share(const BalancedLaw& law, double share) {
  return std::visit([&](const auto& own) -> BalancedLaw { return own.at_share(share); }, law);
}
/// @param omega    Ω of the series
/// @param samples  kExact, or their number
/// @param leading  orders by which there are derivatives, up to L ≤ H
[[nodiscard]] inline BalancedForce balanced_force(const BalancedLaw& law, const TrigonometricPolynomial& y,
                                                  double omega, int samples, const Orders& leading) {
  return std::visit([&](const auto& own) { return own.force(y, omega, samples, leading); }, law);
}
[[nodiscard]] inline Passage passage(const BalancedLaw& law, const TrigonometricPolynomial& y, double omega) {
  return std::visit([&](const auto& own) { return own.passage(y, omega); }, law);
}
[[nodiscard]] inline std::complex<double> impedance(const BalancedLaw& law, double omega) {
  return std::visit([&](const auto& own) -> std::complex<double> { return own.impedance(omega); }, law);
}
[[nodiscard]] inline double strongest(const BalancedLaw& law, double omega) {
  return std::visit([&](const auto& own) { return own.strongest(omega); }, law);
}
/// How the force of a law without memory answers a motion beside y. @param moments  M @param jumps  with those of
/// forces
[[nodiscard]] ForceTangent tangent(const BalancedLaw& law, const TrigonometricPolynomial& y, double omega,
                                   Eigen::Index moments, bool jumps);
/// The contact's own state at θ = 0; nothing where it has none.
[[nodiscard]] std::optional<double> own_state(const BalancedLaw& law, const TrigonometricPolynomial& y);

/// Of a system's contacts.
[[nodiscard]] std::vector<BalancedLaw> balanced_laws(const dynamics::HybridSystem& system);

/// What the contacts' counterpart does under a shaker, d = Re(p e^{i order θ}); at rest under a force.
/// @param order  periods of the drive in one of the series
[[nodiscard]] TrigonometricPolynomial counterpart_motion(const friction::Drive& drive, int order,
                                                         Eigen::Index harmonics);

/// A place's displacement as a law sees it, y or y − d. @param d  of as many orders
[[nodiscard]] TrigonometricPolynomial seen_by(const BalancedLaw& law, const TrigonometricPolynomial& y,
                                              const TrigonometricPolynomial& d);

}  // namespace slipmode::orbits
