#pragma once

// Events and contact modes in result files.

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/results/store.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

void save_events(StoreWriter& store, const std::string& group, const std::vector<dynamics::Event>& events);
[[nodiscard]] std::vector<dynamics::Event> load_events(const StoreReader& store, const std::string& group);

/// @param what  said before the list of codes
void save_modes(StoreWriter& store, const std::string& name, const std::vector<dynamics::ContactMode>& modes,
                const std::string& what);
[[nodiscard]] std::vector<dynamics::ContactMode> load_modes(const StoreReader& store, const std::string& name);

}  // namespace slipmode::results
