#pragma once

#include <slipmode/results/sweep_store.hpp>
#include "cli/session.hpp"
#include "cli/text_table.hpp"

#include <vector>

namespace slipmode::cli {

/// How often each motion was met, for people and for programs.
struct MotionTable {
  TextTable text;
  Json json;
};
/// @param points  number of values swept
[[nodiscard]] MotionTable motion_table(const std::vector<results::MotionCount>& counts, std::size_t points);

/// The values that failed, with why. @param points  of a belt's sweep or of a shaker's
template <class Point>
[[nodiscard]] Json failures_of(const std::vector<Point>& points) {
  Json failures = Json::array();
  for (const Point& point : points)
    if (!point.ok()) failures.push_back({{"value", point.parameter}, {"reason", point.failure}});
  return failures;
}

/// Says at the report's end how many values failed; when all did, the exit code says so too.
void report_failures(Report& report, const Json& failures, std::size_t points);

}  // namespace slipmode::cli
