#include "cli/interrupt.hpp"

#include <csignal>

namespace slipmode::cli {
namespace {

StopFlag stop_requested = false;
static_assert(StopFlag::is_always_lock_free, "only lock-free atomics may be used in a signal handler");

void request_stop(int) { stop_requested.store(true); }

}  // namespace

const StopFlag& watch_for_interrupt() {
  struct sigaction action = {};
  action.sa_handler = request_stop;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGUSR1, &action, nullptr);  // what batch services send before the time is up
  std::signal(SIGXFSZ, SIG_IGN);         // a limit on file sizes is then an error of the write, told like a full disc
  return stop_requested;
}

}  // namespace slipmode::cli
