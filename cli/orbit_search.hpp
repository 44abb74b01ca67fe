#pragma once

#include <slipmode/orbits/shooting.hpp>
#include <slipmode/pod/basis.hpp>
#include "cli/session.hpp"

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace slipmode::cli {

/// Which orbit is looked for and from where: the options that `orbit find` and `orbit continue` share.
struct OrbitSearch {
  std::string scene;
  std::string model = "full";  ///< or "rom:FILE" with a result of 'slipmode reduce'
  int order = 1;               ///< period in periods of the drive
  double period = 0.0;         ///< 0: order times the drive's; on a belt from a simulated recurrence [s]
  int segments = 1;            ///< of multiple shooting
  bool half = false;           ///< look for a symmetric orbit by its half period
  double tolerance = 1e-11;
  int iterations = 30;
  /// "settle", "initial", or the 2n numbers q1,…,qn,v1,…,vn, of the full model also when a reduced one is searched.
  std::string start = "settle";
  double settle = 0.0;  ///< periods of the drive, or time on a belt [s]; 0: what [time] leaves out
};

/// SCENE and the options of a search.
void add_search_options(CLI::App& command, OrbitSearch& search);

/// The model an orbit is looked for in: the scene's own, or its projection on a basis.
struct SearchModel {
  dynamics::HybridSystem full;
  std::optional<pod::Basis> basis = {};

  /// A full model's projection, or the model itself.
  [[nodiscard]] dynamics::HybridSystem of(const dynamics::HybridSystem& system) const;
  /// A full model's state as this model has it.
  [[nodiscard]] dynamics::State of(const dynamics::State& state) const;
  /// "full model, 4 degrees of freedom", "reduced model, 3 modes".
  [[nodiscard]] std::string title() const;
};

/// @throws InvalidInput  for a model that is neither "full" nor "rom:FILE", or a file without a basis for the scene
[[nodiscard]] SearchModel search_model(const OrbitSearch& search, const scene::Scene& scene);

/// Where Newton's method begins, and with which options.
struct SearchStart {
  dynamics::State guess;
  orbits::ShootingOptions options;
};

/// @throws InvalidInput  for a period that is no multiple of the drive's, a start with a wrong number of values, an
///                       order without a periodic drive
[[nodiscard]] SearchStart search_start(const OrbitSearch& search, const scene::Scene& scene, const SearchModel& model);

}  // namespace slipmode::cli
