#pragma once

#include <filesystem>
#include <string>

namespace slipmode::results {

enum class InfoFormat { kText, kJson };

/// What is inside a result file, as a tree: name, shape, units, description; short values shown.
/// @throws InvalidInput  as StoreReader does
[[nodiscard]] std::string info(const std::filesystem::path& path, InfoFormat format = InfoFormat::kText);

}  // namespace slipmode::results
