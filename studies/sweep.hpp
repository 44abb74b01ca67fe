#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/studies/command.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/run_options.hpp>

#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

namespace slipmode::studies {

struct SweepOptions {
  bool follow = false;
  std::size_t segments = 1;
  bool reverse = false;
  bool both = false;
  double exponent_cycles = 0.0;
  results::Journal* journal = nullptr;  ///< keeps finished values and gives back earlier ones; nullptr: in memory only

  static constexpr auto fields() {
    using Own = SweepOptions;
    return std::tuple{
        optional("follow", &Own::follow, "", "each value starts where the one before it ended"),
        optional("segments", &Own::segments, "", "of a sweep that follows: chains side by side", kCount),
        optional("reverse", &Own::reverse, "", "under a shaker or a force: from the last value to the first"),
        optional("both", &Own::both, "", "under a shaker or a force, following: up and down, to show hysteresis"),
        optional("lyapunov", &Own::exponent_cycles, "",
                 "under a shaker or a force: the largest Lyapunov exponent over so many cycles more; 0: none",
                 kNonNegative)};
  }
};

/// Settled motion over values of one key: under a belt `belt`, under a shaker or a force `up` and `down`.
struct Sweep {
  std::vector<double> values;
  std::vector<diagnostics::SweepPoint> belt;
  std::vector<diagnostics::DrivenPoint> up, down;
  bool interrupted = false;
};

/// @throws InvalidInput  for a scene with a force; for options that the scene's drive does not have
void check(const scene::Scene& scene, const SweepOptions& options);

/// A sweep that follows is divided at its chains; up and down are two.
[[nodiscard]] Pieces pieces(const std::vector<double>& values, const SweepOptions& options);

/// @param model  as model_basis
[[nodiscard]] std::string command_of(const Over& over, const std::string& model, const SweepOptions& options);

/// Sweeps a family over its one key from its scene's start, with the times of [validation].
/// @throws InvalidInput  as check
[[nodiscard]] Sweep sweep(const Family& family, const std::vector<double>& values, const SweepOptions& options = {},
                          const RunOptions& run = {});

/// Writes the groups `sweep/full` or `sweep/reduced`, of a downward pass with `_reverse`.
void store(results::StoreWriter& writer, const Family& family, const Sweep& sweep);

}  // namespace slipmode::studies
