#pragma once

// What the two targets of result files share: real results, changes to them out of an input, and what reads them.

#include <slipmode/core/errors.hpp>
#include <slipmode/results/branch_store.hpp>
#include <slipmode/results/orbit_records.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

/// Results in the folder store_seeds, where scripts/fuzz.sh puts them.
inline constexpr std::array<const char*, 5> kSeeds = {"run.h5", "pod.h5", "reduced.h5", "orbit.h5", "branch.h5"};

/// Numbers out of an input, zeros once it is used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : next_(data), left_(size) {}
  [[nodiscard]] bool empty() const { return left_ == 0; }
  [[nodiscard]] unsigned byte() {
    if (left_ == 0) return 0;
    --left_;
    return *next_++;
  }
  void fill(void* out, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) static_cast<std::uint8_t*>(out)[i] = static_cast<std::uint8_t>(byte());
  }

 private:
  const std::uint8_t* next_;
  std::size_t left_;
};

/// What is put in place of a dataset: one of up to three dimensions of up to seven, or nothing.
struct Replacement {
  enum class Kind : std::uint8_t { kDouble, kInteger, kByte, kText, kNone } kind;
  int rank = 0;
  std::array<std::uint64_t, 3> extents{};
  std::size_t count = 1;
  std::array<double, 343> values{};  ///< bytes, of whatever kind

  explicit Replacement(Input& input) : kind(static_cast<Kind>(input.byte() % 5)) {
    if (kind == Kind::kNone) return;
    rank = static_cast<int>(input.byte() % 4);
    for (int d = 0; d < rank; ++d) {
      extents[static_cast<std::size_t>(d)] = input.byte() % 8;
      count *= extents[static_cast<std::size_t>(d)];
    }
    input.fill(values.data(), count * sizeof(double));
  }
};

template <class Read>
void refused_or_read(const Read& read) {
  try {
    read();
  } catch (const slipmode::InvalidInput&) {
  }
}

/// The readers of records, on a store that holds anything.
inline void read_all(const slipmode::results::StoreReader& store) {
  using namespace slipmode::results;
  static_cast<void>(kind_of(store));
  refused_or_read([&] { static_cast<void>(load_provenance(store)); });
  refused_or_read([&] { static_cast<void>(load_trajectory(store)); });
  refused_or_read([&] { static_cast<void>(load_pod(store)); });
  refused_or_read([&] { static_cast<void>(load_reduced(store)); });
  refused_or_read([&] { static_cast<void>(load_orbit(store)); });
  refused_or_read([&] { static_cast<void>(load_branches(store)); });
}
