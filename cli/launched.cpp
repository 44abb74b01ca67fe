#include "cli/launched.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/core/numbers.hpp>
#include <slipmode/core/parallel.hpp>

#include <dlfcn.h>
#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>
#include <algorithm>
#include <cstdlib>

namespace slipmode::cli {
namespace {

std::optional<int> number_of(const char* variable) {
  const char* text = std::getenv(variable);
  return text == nullptr ? std::nullopt : number_in<int>(text);
}

constexpr const char* kWithoutMpi =
    "install an MPI that is found when slipmode is configured (Debian: libopenmpi-dev, openmpi-bin), or start one "
    "process "
    "with --shard I/N for each share";

}  // namespace

Launch launch_in_environment() {
  for (const auto& [own, count] : {std::pair{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"}, {"PMI_RANK", "PMI_SIZE"}})
    if (const auto processes = number_of(count)) return {number_of(own).value_or(0), *processes};
  return {};
}

std::optional<Ranks> join_ranks(const Launch& launch) {
  if (launch.count < 2) return std::nullopt;
  // Found by the executable's run path. Global, for what MPI loads itself.
  void* library = dlopen("slipmode_mpi.so", RTLD_NOW | RTLD_GLOBAL);
  if (library == nullptr) {
    throw InvalidInput(fmt::format("started as one of {} processes, but this slipmode has no MPI ({}); {}",
                                   launch.count, dlerror(), kWithoutMpi));
  }
  const auto join = reinterpret_cast<bool (*)(Ranks&)>(dlsym(library, "slipmode_join_ranks"));
  Ranks ranks;
  if (!join(ranks)) throw InvalidInput("this MPI takes no calls from several threads; install one that does");
  if (ranks.count != launch.count) {
    throw InvalidInput(fmt::format(
        "started as one of {} processes, which the MPI of this slipmode does not know of; start it with the "
        "mpirun of that MPI",
        launch.count));
  }
  return ranks;
}

int threads_of(const Ranks& ranks) {
  const int share = std::max(1, thread_count({}) / ranks.on_machine);
  cpu_set_t bound;
  return sched_getaffinity(0, sizeof bound, &bound) == 0 ? std::min(share, CPU_COUNT(&bound)) : share;
}

}  // namespace slipmode::cli
