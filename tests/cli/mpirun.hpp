#pragma once

#include "cli/slipmode_process.hpp"

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

// Left out, saying so, where there is nothing to start ranks with.
#ifdef SLIPMODE_MPIRUN
#define SLIPMODE_NEEDS_MPIRUN()
#else
#define SLIPMODE_NEEDS_MPIRUN() GTEST_SKIP() << "no mpirun here, or a build without MPI"
#define SLIPMODE_MPIRUN ""
#endif

namespace slipmode::tests {

/// The executable as several ranks, more than there are cores if need be.
/// @param through  program and words that each rank starts the executable with
inline SlipmodeProcess mpirun(int ranks, const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                              const std::vector<std::string>& through = {}) {
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);  // as in a container
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
  std::vector<std::string> launcher = {SLIPMODE_MPIRUN, "-n", std::to_string(ranks)};
  launcher.insert(launcher.end(), through.begin(), through.end());
  return {arguments, folder, launcher};
}

/// The processes that mpirun started so far, rank 0 first.
inline std::vector<pid_t> ranks_of(pid_t launcher) {
  const std::string id = std::to_string(launcher);
  std::ifstream children("/proc/" + id + "/task/" + id + "/children");
  return {std::istream_iterator<pid_t>(children), {}};
}

/// True once a process catches a signal, which would end it before.
inline bool catches(pid_t process, int signal) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string word; status >> word;) {
    std::string mask;
    if (word == "SigCgt:" && status >> mask) return (std::stoull(mask, nullptr, 16) >> (signal - 1) & 1U) != 0;
  }
  return false;
}

}  // namespace slipmode::tests
