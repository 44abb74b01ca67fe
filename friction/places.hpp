#pragma once

#include <slipmode/friction/contact.hpp>

#include <cstddef>
#include <vector>

namespace slipmode::friction {

/// Whether two contacts have the same displacement.
[[nodiscard]] bool same_place(const Contact& a, const Contact& b);

/// Contacts of the same displacement together, by their numbers: elements of a joint, a slider at a stop.
[[nodiscard]] std::vector<std::vector<std::size_t>> by_place(const std::vector<Contact>& contacts);

/// Contacts along one direction together, wherever they count from.
[[nodiscard]] std::vector<std::vector<std::size_t>> by_direction(const std::vector<Contact>& contacts);

}  // namespace slipmode::friction
