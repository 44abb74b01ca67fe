#include <slipmode/friction/places.hpp>

#include <algorithm>

namespace slipmode::friction {

std::vector<std::vector<std::size_t>> by_place(const std::vector<Contact>& contacts) {
  std::vector<std::vector<std::size_t>> places;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const auto same = std::ranges::find_if(places, [&](const std::vector<std::size_t>& place) {
      const Contact& other = contacts[place.front()];
      return other.offset == contacts[c].offset && other.direction == contacts[c].direction;
    });
    if (same != places.end())
      same->push_back(c);
    else
      places.push_back({c});
  }
  return places;
}

}  // namespace slipmode::friction
