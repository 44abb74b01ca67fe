#pragma once

#include <slipmode/core/parallel.hpp>

#include <chrono>
#include <string>

namespace slipmode {

enum class ProgressMode {
  kAutomatic,  ///< only when standard error is a terminal
  kQuiet,      ///< never
  kAlways,     ///< even when standard error is a file
};

/// One line on standard error, rewritten at most ten times a second: label, share done, time left.
///
/// Time left is (time so far)·(items left)/(items done), which is right when items cost about the same. Calls need no
/// lock when they come one at a time, as ProgressCallback promises.
class ProgressLine {
 public:
  explicit ProgressLine(std::string label, ProgressMode mode = ProgressMode::kAutomatic);
  /// Ends the line if one was begun.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void update(std::size_t done, std::size_t total);
  /// A callback that updates this line; it must not outlive it.
  [[nodiscard]] ProgressCallback callback();

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool visible_;
  bool begun_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

/// The text of the line, without carriage return: "label  12/500   2 %  left 1:05".
/// @param elapsed_s  seconds since the start
[[nodiscard]] std::string progress_text(const std::string& label, std::size_t done, std::size_t total,
                                        double elapsed_s);

}  // namespace slipmode
