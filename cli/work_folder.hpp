#pragma once

#include <filesystem>

namespace slipmode::cli {

/// A sibling `DIR.partial` in which a result folder is made, so that DIR never holds half of a result.
///
/// Unless finished or kept, the sibling is removed again, with the parent folders that were made for it. One that an
/// interrupted run left behind stays: it holds the journal from which the same command goes on.
class WorkFolder {
 public:
  /// @throws InvalidInput  when DIR is a file, or its place is not writable
  explicit WorkFolder(std::filesystem::path target);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return work_; }
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }

  /// Leaves the sibling as it is.
  void keep() { settled_ = true; }
  /// Renames the sibling to DIR; when DIR exists, renames file by file into it, replacing those of the same name.
  void finish();

 private:
  std::filesystem::path target_, work_, first_made_;
  bool settled_ = false;
};

}  // namespace slipmode::cli
