#include "cli/orbit_curves.hpp"

#include <slipmode/core/numbers.hpp>
#include "cli/json_values.hpp"
#include "cli/orbit_report.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace slipmode::cli {
namespace {

using orbits::BranchPoint;

std::pair<double, double> reach(const std::vector<BranchPoint>& points, const auto& value) {
  const auto [low, high] = std::ranges::minmax(points, {}, value);
  return {value(low), value(high)};
}

std::string curve_text(const results::NamedBranch& named, const std::vector<std::string>& keys) {
  const orbits::Branch& curve = named.branch;
  std::string text = fmt::format("{}: {} orbits", named.title, curve.points.size());
  if (!curve.points.empty()) {
    const auto over = reach(curve.points, [](const BranchPoint& point) { return *point.other; });
    const auto along = reach(curve.points, [](const BranchPoint& point) { return point.parameter; });
    text += fmt::format(", {} from {:.10g} to {:.10g}, {} from {:.10g} to {:.10g}", keys[0], over.first, over.second,
                        keys[1], along.first, along.second);
  }
  text += fmt::format(", end: {}, {}\n", orbits::to_string(curve.end), curve.reason);
  if (curve.special.empty()) return text;
  TextTable table({"special point", keys[0], keys[1], "±", "note"});
  for (const orbits::SpecialPoint& point : curve.special)
    table.add({orbits::to_string(point.kind), fmt::format("{:.12g}", *point.other),
               fmt::format("{:.12g}", point.parameter), fmt::format("{:.1g}", point.uncertainty), point.note});
  return text + table.str();
}

Json curve_json(const results::NamedBranch& named) {
  const orbits::Branch& curve = named.branch;
  Json special = Json::array(), over = Json::array(), along = Json::array();
  for (const orbits::SpecialPoint& point : curve.special)
    special.push_back(
        merged({{"kind", orbits::to_string(point.kind)}, {"over", *point.other}, {"along", point.parameter}},
               fields_json(point)));
  for (const BranchPoint& point : curve.points) {
    over.push_back(*point.other);
    along.push_back(point.parameter);
  }
  return {{"title", named.title},
          {"points", curve.points.size()},
          {"over", over},
          {"along", along},
          {"end", orbits::to_string(curve.end)},
          {"complete", orbits::is_complete(curve.end)},
          {"reason", curve.reason},
          {"special", special}};
}

}  // namespace

OrbitRange parse_range(const std::string& option, const std::string& text, const std::string& example) {
  const auto complain = [&](const std::string& what) {
    return InvalidInput(fmt::format("{} {}: {}; expected KEY=FROM:TO, e.g. {}", option, text, what, example));
  };
  const std::size_t equals = text.find('=');
  const std::size_t colon = text.find(':', equals == std::string::npos ? 0 : equals);
  if (equals == std::string::npos || equals == 0) throw complain("no KEY=");
  if (colon == std::string::npos) throw complain("no range FROM:TO");
  const auto number = [&](std::size_t begin, std::size_t end) {
    const std::string word = text.substr(begin, end - begin);
    const auto value = number_in<double>(word);
    if (!value || !std::isfinite(*value)) throw complain(fmt::format("'{}' is not a number", word));
    return *value;
  };
  OrbitRange range{text.substr(0, equals), number(equals + 1, colon), number(colon + 1, text.size())};
  if (range.from == range.to) throw complain("the range has no length");
  return range;
}

Report curves_report(const studies::Family& model, const std::shared_ptr<const studies::SpecialCurves>& found,
                     const studies::ContinuationRequest& request, const studies::CurveRequest& curve,
                     const std::string& command, const std::string& output) {
  const std::vector<std::string>& keys = model.keys();
  Report report;
  Json list = Json::array();
  for (const results::NamedBranch& one : found->curves) {
    list.push_back(curve_json(one));
    report.text += curve_text(one, keys);
  }
  report.data = {{"verb", "orbit continue"},
                 {"model", model.title()},
                 {"over", {{"key", keys[0]}, {"from", request.from}, {"to", request.to}, {"start", found->start}}},
                 {"along", {{"key", keys[1]}, {"from", curve.from}, {"to", curve.to}, {"start", found->along}}},
                 {"point", studies::point_text(curve)},
                 {"curves", list}};
  for (const std::string& refused : found->refused) report.text += "not followed: " + refused + "\n";
  if (found->curves.empty()) {
    if (found->interrupted)
      fail_with(report, kInterrupted, "interrupted before a curve was begun; nothing is kept");
    else
      fail_with(report, kNumericalFailure, studies::nothing_followed(*found, keys[0], request, curve));
    return report;
  }
  studies::content_of(model, found, command).save(output);
  tell_file("Curves", output, report);
  const auto lost = [](const results::NamedBranch& one) { return one.branch.end == orbits::BranchEnd::kLost; };
  if (found->interrupted)
    incomplete(report, kInterrupted, "interrupted; what was found is kept");
  else if (std::ranges::any_of(found->curves, lost))
    incomplete(report, kNumericalFailure, "a curve was lost before the end of its ranges; what was found is kept");
  return report;
}

}  // namespace slipmode::cli
