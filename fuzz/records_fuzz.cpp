// Whatever datasets a store holds, they are a result of ours or refused with InvalidInput. As store_fuzz, but in
// memory: all that reads records, ten times as many inputs, without libhdf5.
#include <slipmode/results/memory_store.hpp>
#include "store_input.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <type_traits>
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

template <class From, class T = std::conditional_t<std::is_same_v<From, double>, double, std::int64_t>>
std::shared_ptr<const T> copied(const From* from, std::size_t count) {
  const std::shared_ptr<T[]> values(new T[count]);
  std::copy_n(from, count, values.get());
  return {values, values.get()};
}

/// The dataset of that name as the input has it, and as a file would give it back.
Dataset replaced(const std::string& name, const Replacement& input) {
  using Kind = StoreEntry::Kind;
  constexpr std::array<Kind, 4> kinds = {Kind::kDouble, Kind::kInteger, Kind::kInteger, Kind::kText};
  const auto* const bytes = reinterpret_cast<const unsigned char*>(input.values.data());
  Dataset out{{kinds[static_cast<std::size_t>(input.kind)],
               name,
               {input.extents.begin(), input.extents.begin() + input.rank},
               {}}};
  if (out.kind == Kind::kDouble) out.numbers = copied(input.values.data(), input.count);
  if (input.kind == Replacement::Kind::kByte) out.integers = copied(bytes, input.count);
  if (input.kind == Replacement::Kind::kInteger)
    out.integers = copied(reinterpret_cast<const std::int64_t*>(bytes), input.count);
  if (out.kind == Kind::kText)  // of one character, as in store_fuzz
    for (std::size_t i = 0; i < input.count; ++i)
      out.texts.emplace_back(bytes[i] == 0 ? 0 : 1, static_cast<char>(bytes[i]));
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<MemoryStore> seeds = read_seeds();
  Input input(data, size);
  const MemoryStore& seed = seeds[input.byte() % seeds.size()];
  std::map<std::string, Replacement> changes;
  for (int k = 0; k < 8 && !input.empty(); ++k) {
    const Dataset& chosen = seed.datasets()[input.byte() % seed.datasets().size()];
    if (chosen.kind != StoreEntry::Kind::kGroup) changes.insert_or_assign(chosen.name, Replacement(input));
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
