#pragma once

// What a contact's law asks of one instant.

#include <slipmode/dynamics/system.hpp>

namespace slipmode::selftest {

/// One contact at one instant.
struct ContactInstant {
  double y = 0.0;       ///< displacement, offset included [m]
  double v = 0.0;       ///< wᵀq̇ [m/s]
  double slip = 0.0;    ///< v_drive − wᵀq̇ [m/s]
  double lambda = 0.0;  ///< [N]
  double load = 0.0;    ///< N, negative where contact is lost [N]
  double load_rate = 0.0;
};

/// The run's own sizes, which rounding and tolerances are measured by.
struct ContactScales {
  double way = 1.0;    ///< [m]
  double speed = 1.0;  ///< [m/s]
  double force = 1.0;  ///< [N]
  double place = 0.0;  ///< how deep in a stop a contact may be before a flow tells [m]
  double slack = 0.0;  ///< what a stick's force behind a spring rounds by, as its places do [N]
};

/// What must not be negative while a mode lasts (the least of its guards), and what must be zero, as shares of the
/// scales.
struct LawCheck {
  double guard = 1.0;
  double law = 0.0;
};

/// Written from the formulas of friction/contact.hpp once more, not from the flow.
/// The laws of bristles (Dahl, LuGre) and the stretch of contact springs are histories: `law` is 0 for them.
[[nodiscard]] LawCheck check_law(const friction::Contact& contact, dynamics::ContactMode mode,
                                 const ContactInstant& now, const ContactScales& scales);

/// True when a contact exerts no force whatever happens: it has no guards then.
[[nodiscard]] bool is_idle(const friction::Contact& contact);

}  // namespace slipmode::selftest
