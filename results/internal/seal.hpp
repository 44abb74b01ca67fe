#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace slipmode::results {

/// Bytes before a result's HDF5, its user block. It says who wrote the file, how long the rest is and the rest's
/// CRC-32: libhdf5 1.10 can crash over damaged bytes, so that a damaged file of ours must never reach it.
inline constexpr std::size_t kSealBytes = 512;

/// Fills the user block of a finished file. @return  false when it cannot be written
[[nodiscard]] bool seal(const std::filesystem::path& file);

/// What is wrong with a sealed file, empty when nothing is; and for files without a seal, which others or earlier
/// versions wrote.
[[nodiscard]] std::string damage_of(const std::filesystem::path& file);

/// True for a file with HDF5's signature at its start or behind a user block of a usual size.
[[nodiscard]] bool is_hdf5(const std::filesystem::path& file);

}  // namespace slipmode::results
