#pragma once

#include <slipmode/friction/contact.hpp>

namespace slipmode::friction {

/// Stiffness that a contact adds while it is engaged: of its spring or bristle, or of its stiffest stop; 0 for a law
/// without either [N/m].
[[nodiscard]] double engaged_stiffness(const Law& law);

}  // namespace slipmode::friction
