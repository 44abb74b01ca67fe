#pragma once

#include <filesystem>
#include <string>

namespace slipmode::results {

enum class InfoFormat { kText, kJson };

/// What a result file is and what is inside, as a tree: name, shape, units, description; short values shown.
/// @throws InvalidInput  as StoreReader does
[[nodiscard]] std::string info(const std::filesystem::path& path, InfoFormat format = InfoFormat::kText);

}  // namespace slipmode::results
