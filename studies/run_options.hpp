#pragma once

#include <slipmode/core/parallel.hpp>

#include <functional>
#include <string>

namespace slipmode::studies {

/// How a study is run. Nothing here may change a result, only how long it takes.
struct RunOptions {
  int threads = 0;                 ///< 0: as many as the machine runs at once
  const StopFlag* stop = nullptr;  ///< ends the study after the items now being computed; nullptr: never
  /// Where the progress of a part ("sweep", "ensemble") goes; asked once per part. Empty: nowhere.
  std::function<ProgressCallback(const std::string& part)> progress = {};

  [[nodiscard]] ParallelOptions parallel(const std::string& part) const {
    return {.threads = threads, .stop = stop, .progress = progress ? progress(part) : ProgressCallback()};
  }
  /// @throws Interrupted  when the stop flag is set
  void check_interrupt() const {
    if (stop != nullptr && stop->load()) throw Interrupted();
  }
};

}  // namespace slipmode::studies
