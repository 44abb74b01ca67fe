#pragma once

#include <functional>
#include <optional>
#include <string>

namespace slipmode {

/// What another rank sent.
struct Parcel {
  int from = 0;
  std::string bytes;
};

/// Processes that a launcher as mpirun started together, as one of them sees them. Rank 0 speaks, writes and hands out
/// work. Functions may be called from any thread.
struct Ranks {
  int own = 0;
  int count = 1;
  int on_machine = 1;  ///< of them on this machine, this one among them
  /// Returns at once. What one rank sends to another arrives in that order.
  std::function<void(int to, std::string bytes)> send = {};
  /// What has arrived first; nothing when nothing has. Does not wait.
  std::function<std::optional<Parcel>()> receive = {};
  std::function<void()> leave = {};          ///< the last call of every rank
  std::function<void(int code)> abort = {};  ///< ends all ranks; the launcher's exit code is `code`
};

}  // namespace slipmode
