#pragma once

#include <functional>
#include <string>
#include <vector>

namespace slipmode::selftest {

/// One extreme with the law it must obey. It holds when the measured figure is at most the limit.
struct ExtremeCase {
  std::string name;                 ///< "belt speed 1e-9"
  std::string law;                  ///< what is measured: "release time against closed form, relative"
  double limit = 0.0;               ///< largest figure allowed
  std::function<double()> measure;  ///< the figure; where a clear failure is the law, 0 if it came and 1 if not
  bool is_long = false;             ///< takes more than a few seconds: only on demand
};

/// All cases, in the order of the report: sizes, damping, friction, drives, events, long runs, snapshots, bases.
[[nodiscard]] std::vector<ExtremeCase> extreme_cases();

/// What one case gave. An exception is a figure of infinity, its message the note.
struct ExtremeResult {
  std::string name, law, note;
  double measured = 0.0, limit = 0.0;
  bool holds = false;
};
[[nodiscard]] ExtremeResult run_case(const ExtremeCase& extreme);

// The groups, one file each.
[[nodiscard]] std::vector<ExtremeCase> size_cases();
[[nodiscard]] std::vector<ExtremeCase> friction_cases();
[[nodiscard]] std::vector<ExtremeCase> event_cases();
[[nodiscard]] std::vector<ExtremeCase> reduction_cases();

}  // namespace slipmode::selftest
