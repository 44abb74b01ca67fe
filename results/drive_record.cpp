#include "results/internal/contact_record.hpp"
#include "results/internal/field_record.hpp"

#include <fmt/format.h>

namespace slipmode::results {

void save_drive(StoreWriter& store, const std::string& group, const friction::Drive& drive) {
  const auto describe = [&](const char* kind, const char* what) {
    store.describe_group(group, what);
    store.write(group + "/kind", std::string(kind), {"", "kind of drive"});
  };
  if (const friction::Shaker* shaker = drive.shaker()) {
    describe("shaker", "shaker under the contacts: displacement amplitude sin(2 pi frequency t + phase)");
    save_fields(store, group, *shaker);
  } else if (const friction::Force* force = drive.force()) {
    describe("force", "force on the structure: sum of amplitude sin(order omega t + phase) along directions");
    save_fields(store, group, *force);
    save_rows(store, group, force->harmonics);
  } else {
    describe("belt", "belt under the contacts");
    save_fields(store, group, *drive.belt());
  }
}

friction::Drive load_drive(const StoreReader& store, const std::string& group) {
  const std::string kind = store.text(group + "/kind");
  if (kind == "shaker") return load_fields<friction::Shaker>(store, group);
  if (kind == "belt") return load_fields<friction::Belt>(store, group);
  if (kind != "force") store.fail(group + "/kind", fmt::format("'{}'; expected belt, shaker or force", kind));
  auto force = load_fields<friction::Force>(store, group);
  force.harmonics = load_rows<friction::ForceHarmonic>(store, group);
  return force;
}

}  // namespace slipmode::results
