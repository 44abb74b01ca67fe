#pragma once

#include <slipmode/core/parallel.hpp>

namespace slipmode::cli {

/// Lets the first Ctrl-C (or SIGTERM, SIGUSR1) set a flag that long computations poll; the second one ends the process
/// at once, which loses nothing that was stored.
/// @return the flag; it lives as long as the process, because a signal handler can reach nothing else
[[nodiscard]] const StopFlag& watch_for_interrupt();

}  // namespace slipmode::cli
