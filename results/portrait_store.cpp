#include <slipmode/results/portrait_store.hpp>

#include <fmt/format.h>

namespace slipmode::results {

void store_portraits(StoreWriter& writer, const std::string& group, const PortraitSet& set, const Units& units) {
  if (set.portraits.empty()) return;
  writer.write(group + "/columns", static_cast<std::int64_t>(set.columns), {"", "panels in a row"});
  writer.write(group + "/count", static_cast<std::int64_t>(set.portraits.size()), {"", "number of portraits"});
  for (std::size_t i = 0; i < set.portraits.size(); ++i) {
    const Portrait& portrait = set.portraits[i];
    const std::string name = fmt::format("{}/{:02}/", group, i);
    writer.write(name + "title", portrait.title, {"", "which model, which motion"});
    writer.write(name + "role", portrait.role, {"", "full, or the kind of basis"});
    writer.write(name + "displacement", portrait.displacement, {units.length, "displacement of the first contact"});
    writer.write(name + "velocity", portrait.velocity, {units.velocity, "velocity of the first contact"});
  }
}

PortraitSet load_portraits(const StoreReader& store, const std::string& group) {
  PortraitSet set{.columns = static_cast<int>(store.integer(group + "/columns")), .portraits = {}};
  const std::int64_t count = store.integer(group + "/count");
  for (std::int64_t i = 0; i < count; ++i) {
    const std::string name = fmt::format("{}/{:02}/", group, i);
    const Eigen::VectorXd displacement = store.vector(name + "displacement");
    set.portraits.push_back({.title = store.text(name + "title"),
                             .role = store.text(name + "role"),
                             .displacement = displacement,
                             .velocity = store.vector(name + "velocity", displacement.size())});
  }
  return set;
}

}  // namespace slipmode::results
