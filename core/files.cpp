#include <slipmode/core/files.hpp>

#include <slipmode/core/errors.hpp>

#include <unistd.h>

#include <fmt/format.h>
#include <fstream>

namespace slipmode {

void write_renamed(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::path temporary = path;
  temporary += fmt::format(".{}.partial", getpid());
  std::ofstream out(temporary, std::ios::binary);
  out << text;
  out.close();
  if (!out) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw InvalidInput(fmt::format("cannot write '{}': is the disc full?", path.string()));
  }
  std::filesystem::rename(temporary, path);
}

}  // namespace slipmode
