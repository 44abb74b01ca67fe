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

/// Ends the ranks, each as it calls this: the others tell rank 0 how they ended and wait for it; rank 0 lets them go,
/// or ends them where it failed.
/// @param code     0, or the exit code of this rank
/// @param message  why, where the code is not 0
/// @return what this process exits with: rank 0's code, of others 0, so that the launcher tells rank 0's
int end_ranks(const Ranks& ranks, int code, const std::string& message);

/// First letters of parcels that end_ranks() sends; what ranks send each other otherwise begins with others.
inline constexpr char kFailureParcel = 'f', kGoParcel = 'G';

/// How another rank has ended, for rank 0, which then fails too.
struct RankFailure {
  int rank = 0, code = 0;
  std::string message;

  /// @throws Interrupted         where the rank was stopped
  /// @throws InvalidInput        for its bad input, with its number
  /// @throws std::runtime_error  for all else, with its number
  [[noreturn]] void rethrow() const;
};
/// Nothing where a parcel says something else.
[[nodiscard]] std::optional<RankFailure> failure_in(const Parcel& parcel);

/// @throws InvalidInput  on a rank whose study is another than rank 0's
void require_same_study(const std::string& of_rank_0, const std::string& own);

}  // namespace slipmode
