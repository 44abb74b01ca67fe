#include <slipmode/orbits/shooting.hpp>

#include <algorithm>
#include <cmath>

namespace slipmode::orbits {
namespace {

bool presses_equally(const friction::Contact& contact) {
  if (contact.offset != 0.0 || contact.tilt != 0.0 || !contact.normal_load.is_constant()) return false;
  return friction::is_symmetric(contact.law);
}

bool reverses_after_half_a_period(const friction::Drive& drive) {
  if (drive.shaker() != nullptr) return true;
  if (const friction::Force* force = drive.force())
    return std::all_of(force->harmonics.begin(), force->harmonics.end(), [](const friction::ForceHarmonic& harmonic) {
      return harmonic.order % 2 == 1 || harmonic.amplitude == 0.0;
    });
  return drive.is_constant() && drive.velocity(0.0) == 0.0;
}

}  // namespace

bool is_symmetric(const dynamics::HybridSystem& system) {
  return (system.load().size() == 0 || system.load().isZero(0.0)) &&
         std::all_of(system.contacts().begin(), system.contacts().end(), presses_equally) &&
         reverses_after_half_a_period(system.drive());
}

}  // namespace slipmode::orbits
