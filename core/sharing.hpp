#pragma once

#include <slipmode/core/parallel.hpp>

#include <cstddef>
#include <functional>
#include <vector>

namespace slipmode {

/// How one process shares the pieces of a sweep with others that run beside it and sweep the same. Empty functions: it
/// computes all of them.
struct Sharing {
  /// A sweep begins. @param open  pieces not finished, the same for every process
  /// @param done, total  values finished before, and in all
  /// @param run          its progress is told of the values of every process, its stop flag ends all waiting
  std::function<void(std::vector<std::size_t> open, std::size_t done, std::size_t total, const ParallelOptions& run)>
      begin = {};
  /// Pieces that this process computes next; waits for them. None: all are taken.
  /// @throws Interrupted  when this or another process was stopped
  std::function<std::vector<std::size_t>()> take = {};
  /// This process has computed what it took, or stopped. The one that leads waits for the others.
  /// @param for_all  every process waits, and is given what the others found
  /// @return false when this or another process was stopped
  std::function<bool(bool finished, bool for_all)> end = {};
  bool leads = true;  ///< this process makes the result from what all found
};

}  // namespace slipmode
