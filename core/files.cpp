#include <slipmode/core/files.hpp>

#include <slipmode/core/errors.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>
#include <fstream>
#include <system_error>

namespace slipmode {

namespace {

/// Past caches: what replaces another file must not be lost with the power after that one is gone.
bool is_on_disc(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool done = ::fsync(file) == 0;
  ::close(file);
  return done;
}

}  // namespace

void write_renamed(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::path temporary = path;
  temporary += fmt::format(".{}.partial", getpid());
  std::ofstream out(temporary, std::ios::binary);
  out << text;
  out.close();
  std::error_code failed, ignored;
  if (out && is_on_disc(temporary)) {
    std::filesystem::rename(temporary, path, failed);
    if (!failed) return;
  }
  std::filesystem::remove(temporary, ignored);
  throw InvalidInput(
      fmt::format("cannot write '{}': {}", path.string(), failed ? failed.message() : "is the disc full?"));
}

}  // namespace slipmode
