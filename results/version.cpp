#include <slipmode/results/provenance.hpp>

#ifdef SLIPMODE_HAS_VERSION_HEADER
#include "results/version.hpp"
#else  // built outside the project's CMake
#define SLIPMODE_VERSION "unknown"
#define SLIPMODE_GIT_COMMIT "unknown"
#endif

namespace slipmode::results {

std::string version() { return SLIPMODE_VERSION; }

std::string git_commit() { return SLIPMODE_GIT_COMMIT; }

std::string compiler() {
#if defined(__clang__)
  return "Clang " __clang_version__;
#elif defined(__GNUC__)
  return "GNU " __VERSION__;
#else
  return "unknown";
#endif
}

}  // namespace slipmode::results
