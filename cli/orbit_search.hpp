#pragma once

#include <slipmode/orbits/shooting.hpp>
#include <slipmode/studies/family.hpp>
#include "cli/session.hpp"

#include <CLI/CLI.hpp>
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

/// Where Newton's method begins, and with which options.
struct SearchStart {
  dynamics::State guess;
  orbits::ShootingOptions options;
};

/// @throws InvalidInput  for a period that is no multiple of the drive's, a start with a wrong number of values, an
///                       order without a periodic drive
[[nodiscard]] SearchStart search_start(const OrbitSearch& search, const studies::Family& model);

}  // namespace slipmode::cli
