#pragma once

#include <filesystem>
#include <string>

namespace slipmode::results {

enum class InfoFormat {
  kText,
  kJson,
  /// All values, each group an object: for programs without a reader of HDF5. Arrays are lists of rows; null stands for
  /// what is not finite.
  kValues
};

/// What a result file is and what is inside, as a tree: name, shape, units, description; short values shown.
/// @throws InvalidInput  as StoreReader does
[[nodiscard]] std::string info(const std::filesystem::path& path, InfoFormat format = InfoFormat::kText);

}  // namespace slipmode::results
