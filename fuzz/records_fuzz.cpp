// Whatever datasets a store holds, they are a result of ours or refused with InvalidInput. As store_fuzz, but in
// memory: all that reads records, ten times as many inputs, without libhdf5.
#include <slipmode/results/memory_store.hpp>
#include "store_input.hpp"

#include <cstring>
#include <map>
#include <memory>
#include <vector>

namespace {

using slipmode::results::Dataset;
using slipmode::results::MemoryStore;
using slipmode::results::StoreEntry;
using slipmode::results::StoreReader;

std::vector<MemoryStore> read_seeds() {
  std::vector<MemoryStore> seeds;
  for (const char* name : kSeeds) seeds.emplace_back(StoreReader(std::string("store_seeds/") + name));
  return seeds;
}

template <class T>
std::shared_ptr<const T> values_of(const Replacement& input) {
  static_assert(sizeof(T) == sizeof(double));
  const std::shared_ptr<T[]> values(new T[input.count]);
  std::memcpy(values.get(), input.values.data(), input.count * sizeof(T));
  return {values, values.get()};
}

/// The dataset of that name as the input has it. Bytes are of no kind that is read.
Dataset replaced(const std::string& name, const Replacement& input) {
  using Kind = StoreEntry::Kind;
  constexpr std::array<Kind, 4> kinds = {Kind::kDouble, Kind::kInteger, Kind::kOther, Kind::kText};
  Dataset out{{kinds[static_cast<std::size_t>(input.kind)],
               name,
               {input.extents.begin(), input.extents.begin() + input.rank},
               {}}};
  if (out.kind == Kind::kDouble) out.numbers = values_of<double>(input);
  if (out.kind == Kind::kInteger) out.integers = values_of<std::int64_t>(input);
  if (out.kind == Kind::kText) {
    const auto* bytes = reinterpret_cast<const char*>(input.values.data());
    for (std::size_t i = 0; i < input.count; ++i) out.texts.emplace_back(bytes + i * sizeof(double), sizeof(double));
  }
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<MemoryStore> seeds = read_seeds();
  Input input(data, size);
  const MemoryStore& seed = seeds[input.byte() % seeds.size()];
  std::map<std::string, Replacement> changes;
  for (int k = 0; k < 8 && !input.empty(); ++k) {
    const std::string& name = seed.datasets()[input.byte() % seed.datasets().size()].name;
    changes.insert_or_assign(name, Replacement(input));
  }
  const auto store = std::make_shared<MemoryStore>(slipmode::results::Content{
      slipmode::results::FileKind::kTrajectory, "SI", [](slipmode::results::StoreWriter&) {}});
  for (const Dataset& dataset : seed.datasets()) {
    const auto change = changes.find(dataset.name);
    if (change == changes.end())
      store->add(dataset);
    else if (change->second.kind != Replacement::Kind::kNone)
      store->add(replaced(dataset.name, change->second));
  }
  read_all(StoreReader(store));
  return 0;
}
