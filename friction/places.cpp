#include <slipmode/friction/places.hpp>

#include <algorithm>

namespace slipmode::friction {

namespace {

/// Numbers of contacts that are alike, in order of the first ones.
template <class Alike>
std::vector<std::vector<std::size_t>> grouped(const std::vector<Contact>& contacts, const Alike& alike) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const auto own = std::ranges::find_if(
        groups, [&](const std::vector<std::size_t>& group) { return alike(contacts[group.front()], contacts[c]); });
    if (own != groups.end())
      own->push_back(c);
    else
      groups.push_back({c});
  }
  return groups;
}

bool same_direction(const Contact& a, const Contact& b) { return a.direction == b.direction; }

}  // namespace

bool same_place(const Contact& a, const Contact& b) { return a.offset == b.offset && same_direction(a, b); }

std::vector<std::vector<std::size_t>> by_place(const std::vector<Contact>& contacts) {
  return grouped(contacts, same_place);
}

std::vector<std::vector<std::size_t>> by_direction(const std::vector<Contact>& contacts) {
  return grouped(contacts, same_direction);
}

}  // namespace slipmode::friction
