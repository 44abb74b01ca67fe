#pragma once

#include <slipmode/diagnostics/series/series_study.hpp>

#include <string>
#include <vector>

namespace slipmode::diagnostics {

/// One number of a study, with its uncertainty and how it was come by.
struct Finding {
  std::string key;       ///< for programs: "delay", "wolf", …
  std::string quantity;  ///< for people
  double value = 0.0;
  double error = 0.0;  ///< NaN: exact, or not known (the settings say which)
  std::string unit;    ///< "" for counts
  std::string settings;
};

/// What a study found, number by number; tools that did not run give none.
/// @param bits  exponents and information in bits rather than nats
[[nodiscard]] std::vector<Finding> findings_of(const SeriesStudy& study, bool bits);

/// "0.94 ± 0.03": as many digits as the error allows, two of it.
[[nodiscard]] std::string with_error(double value, double error);

}  // namespace slipmode::diagnostics
