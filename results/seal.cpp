#include "results/internal/seal.hpp"

#include <fmt/format.h>
#include <zlib.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <vector>

namespace slipmode::results {
namespace {

constexpr std::string_view kOurs = "slipmode result: HDF5 from byte 512 on";

/// The whole block.
std::string block_of(std::uintmax_t size, std::uint32_t crc) {
  std::string block = fmt::format("{}, {} bytes, CRC-32 {:08x}\n", kOurs, size, crc);
  block.resize(kSealBytes, '\0');
  return block;
}

/// Of all behind the block. @return  false where not all of `size` can be read
bool crc_of_rest(std::istream& in, std::uintmax_t size, std::uint32_t& out_crc) {
  std::vector<char> piece(std::size_t{1} << 20);
  in.seekg(kSealBytes);
  uLong crc = crc32_z(0, nullptr, 0);
  for (std::uintmax_t left = size; left > 0;) {
    const auto wanted = static_cast<std::streamsize>(std::min<std::uintmax_t>(left, piece.size()));
    if (!in.read(piece.data(), wanted)) return false;
    crc = crc32_z(crc, reinterpret_cast<const Bytef*>(piece.data()), static_cast<z_size_t>(wanted));
    left -= static_cast<std::uintmax_t>(wanted);
  }
  out_crc = static_cast<std::uint32_t>(crc);
  return true;
}

}  // namespace

bool seal(const std::filesystem::path& file) {
  std::error_code gone;
  const std::uintmax_t size = std::filesystem::file_size(file, gone) - kSealBytes;
  std::fstream both(file, std::ios::binary | std::ios::in | std::ios::out);
  std::uint32_t crc = 0;
  if (gone || !crc_of_rest(both, size, crc)) return false;
  const std::string block = block_of(size, crc);
  both.seekp(0);
  both.write(block.data(), static_cast<std::streamsize>(block.size()));
  return both.flush().good();
}

std::string damage_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string block(kSealBytes, '\0');
  if (!in.read(block.data(), static_cast<std::streamsize>(block.size())) || !block.starts_with(kOurs)) return "";
  const std::uintmax_t size = std::filesystem::file_size(file) - kSealBytes;
  std::uint32_t crc = 0;
  if (!crc_of_rest(in, size, crc)) return "cannot be read to its end";
  return block == block_of(size, crc) ? "" : "is damaged: its length or checksum is not what was written";
}

bool is_hdf5(const std::filesystem::path& file) {
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
  std::ifstream in(file, std::ios::binary);
  for (const std::streamoff begin : {0, 512, 1024, 2048}) {
    std::array<char, 8> bytes{};
    if (!in.seekg(begin) || !in.read(bytes.data(), bytes.size())) return false;
    if (std::string_view(bytes.data(), bytes.size()) == kSignature) return true;
  }
  return false;
}

}  // namespace slipmode::results
