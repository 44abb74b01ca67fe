#pragma once

// Contacts and drives in result files, for records.hpp.

#include <slipmode/friction/contact.hpp>
#include <slipmode/friction/drive.hpp>
#include <slipmode/results/store.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

/// @param n  length of the contacts' directions (also when there are none)
void save_contacts(StoreWriter& store, const std::string& group, const std::vector<friction::Contact>& contacts,
                   Eigen::Index n);
[[nodiscard]] std::vector<friction::Contact> load_contacts(const StoreReader& store, const std::string& group,
                                                           Eigen::Index n);

void save_drive(StoreWriter& store, const std::string& group, const friction::Drive& drive);
[[nodiscard]] friction::Drive load_drive(const StoreReader& store, const std::string& group);

}  // namespace slipmode::results
