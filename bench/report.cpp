#include "bench/report.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::bench {
namespace {

double per_ten_thousand(double seconds_per_unit) { return 1e3 * 1e4 * seconds_per_unit; }

std::string wanted(double ratio) { return ratio > 0.0 ? fmt::format("{:.0f}", ratio) : "-"; }

}  // namespace

std::string time_header() {
  constexpr const char* kForm = "{:<19} {:>6} {:>9} {:>9} {:>6} {:>6} {:>9} {:>9} {:>8} {:>6} {:>8} {:>6} {:>8} {:>8}";
  return fmt::format(kForm, "", "events", "slipmode", "audit off", "on/", "proof/", "CVODE", "dopri5", "CVODE/",
                     "wanted", "dopri5/", "wanted", "set-up", "+shapes") +
         "\n" +
         fmt::format(kForm, "case", "/unit", "ms/1e4", "ms/1e4", "off", "none", "ms/1e4", "ms/1e4", "slipmode", "",
                     "slipmode", "", "ms", "ms");
}

std::string time_line(const Comparison& row) {
  return fmt::format(
      "{:<19} {:>6.3f} {:>9.3f} {:>9.3f} {:>6.2f} {:>6.2f} {:>9.1f} {:>9.2f} {:>8.0f} {:>6} {:>8.1f} {:>6} {:>7.2f}{} "
      "{:>8.2f}",
      row.setting.problem.name, row.slipmode.events_per_unit, per_ten_thousand(row.slipmode.seconds),
      per_ten_thousand(row.plain_seconds), row.slipmode.seconds / row.plain_seconds,
      row.certified_seconds / row.slipmode.seconds, per_ten_thousand(row.cvode.seconds),
      per_ten_thousand(row.odeint.seconds), row.ratio_cvode(), wanted(row.setting.wanted_cvode), row.ratio_odeint(),
      wanted(row.setting.wanted_odeint), 1e3 * row.setup_rows_seconds, row.setting.setup_counts ? "+" : " ",
      1e3 * row.setup_shapes_seconds);
}

Timed timed(const Comparison& row) {
  return {.name = row.setting.problem.name,
          .ms = per_ten_thousand(row.slipmode.seconds),
          .audit_on_off = row.slipmode.seconds / row.plain_seconds,
          .ratio_cvode = row.ratio_cvode(),
          .ratio_dopri5 = row.ratio_odeint(),
          .error = row.slipmode.error};
}

std::string error_header() {
  return fmt::format("{:<19} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}  {}", "errors: median, worst", "toler.",
                     "slipmode", "", "CVODE", "", "dopri5", "", "events", "agree");
}

std::string error_line(const Comparison& row) {
  const bool agree = std::isfinite(row.slipmode.event_time_error) && std::isfinite(row.cvode.event_time_error) &&
                     std::isfinite(row.odeint.event_time_error);
  const auto pair = [](const MethodFigures& m) { return fmt::format("{:>8.1e} {:>8.1e}", m.error, m.worst_error); };
  return fmt::format(
      "{:<21} {:>6.0e} {} {} {} {:>8}  {}", row.setting.problem.name, row.slipmode.tolerance, pair(row.slipmode),
      pair(row.cvode), pair(row.odeint), row.reference_events,
      agree ? "yes" : fmt::format("no: {} {} {}", row.slipmode.events, row.cvode.events, row.odeint.events));
}

std::string tanh_header() {
  return fmt::format("{:<19} {:>8} {:>9} {:>10} {:>9} {:>8}", "tanh law, BDF", "epsilon", "ms/1e4", "/slipmode",
                     "/CVODE", "error");
}

std::string tanh_line(const TanhFigures& row) {
  return fmt::format("{:<19} {:>8.0e} {:>9.1f} {:>10.0f} {:>9.2f} {:>8.1e}", row.setting.problem.name, row.epsilon,
                     per_ten_thousand(row.seconds), row.seconds / row.slipmode_seconds, row.seconds / row.cvode_seconds,
                     row.error);
}

}  // namespace slipmode::bench
