#pragma once

#include <filesystem>
#include <string>

namespace slipmode {

/// Writes a text under a temporary name and renames it once it is on the disc.
/// @throws InvalidInput  when it cannot be written
void write_renamed(const std::filesystem::path& path, const std::string& text);

}  // namespace slipmode
