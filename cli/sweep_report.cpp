#include "cli/sweep_report.hpp"

#include <fmt/format.h>

namespace slipmode::cli {

MotionTable motion_table(const std::vector<results::MotionCount>& counts, std::size_t points) {
  MotionTable out{TextTable({"motion", "values", "share [%]"}), Json::object()};
  for (const results::MotionCount& count : counts) {
    const double share = 100.0 * static_cast<double>(count.values) / static_cast<double>(points);
    out.text.add({count.motion, fmt::format("{}", count.values), fixed(share, 1)});
    out.json[count.motion] = count.values;
  }
  return out;
}

void report_failures(Report& report, const Json& failures, std::size_t points) {
  if (failures.empty()) return;
  report.text += fmt::format("{} values failed, first at {:g}: {}\n", failures.size(),
                             failures.front()["value"].get<double>(), failures.front()["reason"].get<std::string>());
  if (failures.size() == points) report.exit_code = kNumericalFailure;
}

}  // namespace slipmode::cli
