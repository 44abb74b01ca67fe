#pragma once

#include <slipmode/friction/contact.hpp>

#include <cstddef>
#include <vector>

namespace slipmode::friction {

/// Contacts of the same displacement together, by their numbers: elements of a joint, a slider at a stop.
[[nodiscard]] std::vector<std::vector<std::size_t>> by_place(const std::vector<Contact>& contacts);

}  // namespace slipmode::friction
