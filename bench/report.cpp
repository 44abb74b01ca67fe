#include "bench/report.hpp"

#include <fmt/format.h>
#include <cmath>
#include <fstream>

namespace slipmode::bench {
namespace {

double per_ten_thousand(double seconds, double duration) { return 1e3 * seconds * 1e4 / duration; }

std::string wanted(double ratio) { return ratio > 0.0 ? fmt::format("{:.0f}", ratio) : "-"; }

}  // namespace

std::string comparison_header() {
  return fmt::format(
             "{:<17} {:>6} {:>7} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} {:>7} {:>6} {:>7} {:>6}  {:>7} {:>7} {:>7}  {}",
             "", "events", "toler.", "run", "audited", "set-up", "+shapes", "CVODE", "dopri5", "CVODE/", "wanted",
             "dopri5/", "wanted", "error", "CVODE", "dopri5", "events") +
         fmt::format(
             "\n{:<17} {:>6} {:>7} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} {:>7} {:>6} {:>7} {:>6}  {:>7} {:>7} {:>7}  {}",
             "case", "/unit", "", "ms/1e4", "ms/1e4", "ms", "ms", "ms/1e4", "ms/1e4", "run", "", "run", "", "", "", "",
             "agree");
}

std::string comparison_line(const Comparison& row) {
  const double T = row.setting.duration;
  const bool agree = std::isfinite(row.slipmode.event_time_error) && std::isfinite(row.cvode.event_time_error) &&
                     std::isfinite(row.odeint.event_time_error);
  return fmt::format(
      "{:<17} {:>6.3f} {:>7.0e} {:>8.3f} {:>8.3f} {:>8.2f} {:>8.2f} {:>9.1f} {:>8.2f} {:>7.0f} {:>6} {:>7.1f} {:>6}  "
      "{:>7.1e} {:>7.1e} {:>7.1e}  {}",
      row.setting.problem.name, static_cast<double>(row.slipmode.timed_events) / T, row.slipmode.tolerance,
      per_ten_thousand(row.slipmode.seconds, T), per_ten_thousand(row.audit_seconds, T), 1e3 * row.setup_rows_seconds,
      1e3 * row.setup_shapes_seconds, per_ten_thousand(row.cvode.seconds, T), per_ten_thousand(row.odeint.seconds, T),
      row.ratio_cvode(), wanted(row.setting.wanted_cvode), row.ratio_odeint(), wanted(row.setting.wanted_odeint),
      row.slipmode.error, row.cvode.error, row.odeint.error,
      agree ? fmt::format("yes ({})", row.reference_events)
            : fmt::format("{}/{}/{} of {}", row.slipmode.events, row.cvode.events, row.odeint.events,
                          row.reference_events));
}

std::string tanh_header() {
  return fmt::format("{:<17} {:>8} {:>9} {:>10} {:>9} {:>8}", "tanh law, BDF", "epsilon", "ms/1e4", "/slipmode",
                     "/CVODE", "error");
}

std::string tanh_line(const TanhFigures& row) {
  return fmt::format("{:<17} {:>8.0e} {:>9.1f} {:>10.0f} {:>9.2f} {:>8.1e}", row.setting.problem.name, row.epsilon,
                     per_ten_thousand(row.seconds, row.setting.duration), row.seconds / row.slipmode_seconds,
                     row.seconds / row.cvode_seconds, row.error);
}

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

}  // namespace slipmode::bench
