#pragma once

// Events and contact modes in result files.

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/results/store.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

inline constexpr const char* kModeWords =
    "-1 slip-, 0 stick, 1 slip+, 2 smooth, 3 contact lost, 4 gap, 5 left stop, 6 right stop, 7 and 8 in flight beyond "
    "the left and the right stop";

void save_events(StoreWriter& store, const std::string& group, const std::vector<dynamics::Event>& events);
[[nodiscard]] std::vector<dynamics::Event> load_events(const StoreReader& store, const std::string& group);

/// @param what  said before the list of codes
void save_modes(StoreWriter& store, const std::string& name, const std::vector<dynamics::ContactMode>& modes,
                const std::string& what);
[[nodiscard]] std::vector<dynamics::ContactMode> load_modes(const StoreReader& store, const std::string& name);

}  // namespace slipmode::results
