#include "cli/features.hpp"

#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/report/report.hpp>
#include <slipmode/results/provenance.hpp>

#include <fmt/format.h>
#include <string_view>

namespace slipmode::cli {
namespace {

// What the build was configured with: CMakeLists.txt beside this file.
constexpr std::string_view kArch = SLIPMODE_BUILT_ARCH;
constexpr std::string_view kPython = SLIPMODE_BUILT_PYTHON;
constexpr bool kHasFftw = SLIPMODE_BUILT_FFTW;
constexpr bool kHasMpi = SLIPMODE_BUILT_MPI;

std::string processor() { return kArch.empty() ? "the compiler's default" : std::string(kArch); }

std::string kernel_sets() {
  std::string names;
  for (const auto* set : kernels::available()) names += (names.empty() ? "" : ", ") + std::string(set->name);
  return fmt::format("{} in use; this processor runs {}", kernels::kernels().name, names);
}

}  // namespace

std::vector<Feature> features() {
  return {
      {"processor", processor()},
      {"kernels", kernel_sets()},
      {"fourier", kHasFftw ? "FFTW" : "KISS FFT: built without FFTW"},
      {"report", report::is_available() ? "D3" : "none: built without D3"},
      {"mpi", kHasMpi ? "studies under mpirun" : "none: built without MPI"},
      {"python", kPython.empty() ? "none: built without pybind11" : fmt::format("package for Python {}", kPython)},
  };
}

std::string version_text() {
  std::string text = fmt::format("slipmode {} ({}, {}; kernels {})", results::version(), results::git_commit(),
                                 results::compiler(), kernels::kernels().name);
  for (const Feature& feature : features()) text += fmt::format("\n{:<10} {}", feature.name, feature.value);
  return text;
}

std::string dataset_folder() { return SLIPMODE_DATASETS; }

}  // namespace slipmode::cli
