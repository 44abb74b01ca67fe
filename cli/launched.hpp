#pragma once

#include <slipmode/core/ranks.hpp>

#include <optional>

namespace slipmode::cli {

/// What a launcher of MPI programs says in the environment.
struct Launch {
  int own = 0;    ///< this process's rank
  int count = 1;  ///< of processes; 1: none has started this one, or it alone
};
[[nodiscard]] Launch launch_in_environment();

/// Joins the others that the launcher started; nothing for a process on its own, which MPI costs nothing. Called once.
/// @throws InvalidInput  when this build is without MPI, or the launcher is of another one
[[nodiscard]] std::optional<Ranks> join_ranks(const Launch& launch);

/// Threads of a rank for which none are asked: its share of the machine, or the cores that it is bound to.
[[nodiscard]] int threads_of(const Ranks& ranks);

}  // namespace slipmode::cli
