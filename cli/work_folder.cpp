#include "cli/work_folder.hpp"

#include <slipmode/core/errors.hpp>

#include <unistd.h>

#include <fmt/format.h>
#include <cerrno>
#include <cstring>

namespace slipmode::cli {
namespace {

namespace fs = std::filesystem;

/// The uppermost folder on the way to `path` that does not exist; empty when all do.
fs::path first_missing(const fs::path& path) {
  fs::path missing;
  for (fs::path at = path; !at.empty() && !fs::exists(at); at = at.parent_path()) missing = at;
  return missing;
}

}  // namespace

WorkFolder::WorkFolder(fs::path target) {
  target_ = fs::absolute(target).lexically_normal();
  if (!target_.has_filename()) target_ = target_.parent_path();
  work_ = target_;
  work_ += ".partial";
  if (fs::exists(target_) && !fs::is_directory(target_)) {
    throw InvalidInput(fmt::format("-o {}: this is a file; give a folder", target.string()));
  }
  first_made_ = first_missing(work_);
  std::error_code error;
  fs::create_directories(work_, error);
  const int problem = error                                                              ? error.value()
                      : access(work_.c_str(), W_OK | X_OK) != 0                          ? errno
                      : fs::exists(target_) && access(target_.c_str(), W_OK | X_OK) != 0 ? errno
                                                                                         : 0;
  if (problem == 0) return;
  if (!error && !first_made_.empty()) fs::remove_all(first_made_, error);
  throw InvalidInput(
      fmt::format("-o {}: cannot write there: {}; choose another folder", target.string(), std::strerror(problem)));
}

WorkFolder::~WorkFolder() {
  if (settled_ || first_made_.empty()) return;
  std::error_code ignored;
  fs::remove_all(first_made_, ignored);
}

void WorkFolder::finish() {
  settled_ = true;
  if (!fs::exists(target_)) {
    fs::rename(work_, target_);
    return;
  }
  for (const auto& entry : fs::directory_iterator(work_)) {
    fs::rename(entry.path(), target_ / entry.path().filename());
  }
  fs::remove(work_);
}

}  // namespace slipmode::cli
