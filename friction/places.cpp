#include <slipmode/friction/places.hpp>

#include <algorithm>

namespace slipmode::friction {

bool same_place(const Contact& a, const Contact& b) { return a.offset == b.offset && a.direction == b.direction; }

std::vector<std::vector<std::size_t>> by_place(const std::vector<Contact>& contacts) {
  std::vector<std::vector<std::size_t>> places;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const auto own = std::ranges::find_if(places, [&](const std::vector<std::size_t>& place) {
      return same_place(contacts[place.front()], contacts[c]);
    });
    if (own != places.end())
      own->push_back(c);
    else
      places.push_back({c});
  }
  return places;
}

}  // namespace slipmode::friction
