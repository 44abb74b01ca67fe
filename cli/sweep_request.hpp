#pragma once

#include <slipmode/scene/scene.hpp>
#include "cli/session.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

/// What `slipmode sweep` was asked for.
struct SweepRequest {
  std::string scene, over, output;
  std::string model = "full";
  bool follow = false, reverse = false, both = false;
  std::size_t segments = 1;
  double exponent_cycles = 0.0;
};

/// KEY=FROM:TO:STEP.
struct Over {
  std::string key;
  std::vector<double> values;
};

/// @throws InvalidInput  saying what is wrong with the text
[[nodiscard]] Over parse_over(const std::string& text);

/// Every value is tried before the first is computed: a typing error must not show after an hour.
/// @throws InvalidInput  for a value the scene refuses or that changes the number of degrees of freedom
void check_values(const scene::Scene& scene, const Over& over);

/// @throws InvalidInput  for options that only a shaker's sweep has
void require_belt_request(const SweepRequest& request);

/// A short name of a file's bytes.
[[nodiscard]] std::string file_fingerprint(const std::string& path);

/// What to say when Ctrl-C came: how far it got, of both passes where there are two, and that the same command goes on.
[[nodiscard]] Report interrupted_sweep(const SweepRequest& request, const Over& over, std::size_t finished);

/// The sweep of a scene with a shaker.
[[nodiscard]] Report run_shaken_sweep(const Session& session, const SweepRequest& request, const Over& over,
                                      const scene::Scene& scene);

}  // namespace slipmode::cli
