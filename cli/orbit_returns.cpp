#include <slipmode/diagnostics/series/embedding.hpp>
#include <slipmode/orbits/close_returns.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/table.hpp>
#include "cli/field_options.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

namespace slipmode::cli {
namespace {

struct OrbitReturnsArguments {
  std::string series, output;
  Eigen::Index column = 0, delay = 1;
  int dimension = 3;
  orbits::ReturnOptions search = {.min_length = 2, .max_length = 0, .threshold = 0.0, .per_length = 1000};
};

/// Returns whose lengths are about the same: one approximate orbit, seen several times.
struct Recurrence {
  orbits::CloseReturn nearest;
  std::size_t count = 0;
  Eigen::Index shortest = 0, longest = 0;
};

/// FILE:DATASET, a column of it.
Eigen::VectorXd read_series(const OrbitReturnsArguments& arguments) {
  const std::size_t colon = arguments.series.rfind(':');
  if (colon == std::string::npos) {
    throw InvalidInput(fmt::format("{}: expected FILE:DATASET, e.g. run.h5:trajectory/v ('slipmode info' lists them)",
                                   arguments.series));
  }
  const results::StoreReader store(arguments.series.substr(0, colon));
  const std::string name = arguments.series.substr(colon + 1);
  const auto shape = store.entry(name).shape;
  if (shape.size() == 1) return store.vector(name);
  const Eigen::MatrixXd values = store.matrix(name);
  if (values.cols() == 1 && arguments.column == 0) return values.col(0);
  if (arguments.column < 1 || arguments.column > values.cols()) {
    throw InvalidInput(
        fmt::format("--column {}: '{}' has columns 1 to {}; say which", arguments.column, name, values.cols()));
  }
  return values.col(arguments.column - 1);
}

/// The nearest return of all, with those whose length is within a fiftieth of its own, then the nearest of the rest,
/// and so on; by length.
std::vector<Recurrence> recurrences_of(std::vector<orbits::CloseReturn> returns) {
  constexpr double kAlike = 0.02;
  std::ranges::stable_sort(returns, {}, &orbits::CloseReturn::distance);
  std::vector<Recurrence> groups;
  for (const orbits::CloseReturn& found : returns) {
    const auto alike = std::ranges::find_if(groups, [&](const Recurrence& group) {
      const auto length = static_cast<double>(group.nearest.length);
      return std::abs(static_cast<double>(found.length) - length) <= std::max(1.0, kAlike * length);
    });
    if (alike == groups.end()) {
      groups.push_back({found, 1, found.length, found.length});
      continue;
    }
    ++alike->count;
    alike->shortest = std::min(alike->shortest, found.length);
    alike->longest = std::max(alike->longest, found.length);
  }
  std::ranges::sort(groups, {}, [](const Recurrence& group) { return group.nearest.length; });
  return groups;
}

std::vector<double> column_of(const std::vector<Recurrence>& groups, double (*number)(const Recurrence&)) {
  std::vector<double> values;
  for (const Recurrence& group : groups) values.push_back(number(group));
  return values;
}

void store_groups(const OrbitReturnsArguments& arguments, const Eigen::MatrixXd& points,
                  const std::vector<Recurrence>& groups) {
  results::StoreWriter writer(arguments.output, results::FileKind::kReturns);
  writer.describe_group("returns", fmt::format("close returns of {}, delay {}, dimension {}", arguments.series,
                                               arguments.delay, arguments.dimension));
  results::save(
      writer, "returns/orbits",
      results::Table{"approximate orbits, by length; lengths and instants in samples",
                     {{"length",
                       {"", "of the nearest return"},
                       column_of(groups, [](const Recurrence& g) { return static_cast<double>(g.nearest.length); })},
                      {"begin",
                       {"", "instant the nearest return begins at, from 0"},
                       column_of(groups, [](const Recurrence& g) { return static_cast<double>(g.nearest.begin); })},
                      {"distance",
                       {"1", "of the nearest return, in the unit of the series"},
                       column_of(groups, [](const Recurrence& g) { return g.nearest.distance; })},
                      {"returns", {"", "how many were seen"}, column_of(groups, [](const Recurrence& g) {
                         return static_cast<double>(g.count);
                       })}}});
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const orbits::CloseReturn& nearest = groups[k].nearest;
    writer.write_columns(fmt::format("returns/orbit_{:03}", k + 1),
                         points.middleCols(nearest.begin, nearest.length + 1), {"1", "delay coordinates along it"});
  }
  writer.commit();
}

Report run(const OrbitReturnsArguments& arguments) {
  if (!arguments.output.empty()) require_writable(arguments.output);
  const Eigen::MatrixXd points =
      diagnostics::delay_vectors({.values = read_series(arguments), .name = arguments.series},
                                 {.dimension = arguments.dimension, .lag = arguments.delay});
  orbits::ReturnOptions search = arguments.search;
  if (search.threshold == 0.0) search.threshold = orbits::half_mean_step(points);
  if (search.max_length == 0) search.max_length = std::max(points.cols() / 4, search.min_length);
  const std::vector<Recurrence> groups = recurrences_of(orbits::path_returns(points, search));
  if (!arguments.output.empty()) store_groups(arguments, points, groups);

  Report report;
  TextTable table({"orbit", "samples", "from", "to", "returns", "distance", "begin"});
  Json list = Json::array();
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const Recurrence& group = groups[k];
    table.add({std::to_string(k + 1), std::to_string(group.nearest.length), std::to_string(group.shortest),
               std::to_string(group.longest), std::to_string(group.count),
               fmt::format("{:.3g}", group.nearest.distance), std::to_string(group.nearest.begin)});
    list.push_back({{"length", group.nearest.length},
                    {"shortest", group.shortest},
                    {"longest", group.longest},
                    {"returns", group.count},
                    {"distance", group.nearest.distance},
                    {"begin", group.nearest.begin}});
  }
  report.data = {
      {"verb", "orbit returns"}, {"points", points.cols()}, {"threshold", search.threshold}, {"orbits", list}};
  report.text = fmt::format("{} points in {} delay coordinates, closer than {:.3g}\n{}", points.cols(),
                            arguments.dimension, search.threshold, table.str());
  if (groups.empty()) report.text += "No close return; raise --threshold, or record longer\n";
  tell_file("Returns", arguments.output, report);
  return report;
}

}  // namespace

Verb add_orbit_returns(CLI::App& orbit) {
  CLI::App* command = orbit.add_subcommand("returns", "approximate orbits in a measured series");
  const auto arguments = std::make_shared<OrbitReturnsArguments>();
  command->add_option("SERIES", arguments->series, "FILE:DATASET of a result file, e.g. run.h5:trajectory/v")
      ->required();
  command->add_option("--column", arguments->column, "column of the dataset, from 1, when it has several");
  command->add_option("--delay", arguments->delay, "delay of the coordinates, in samples")->check(within(kCount, true));
  command->add_option("--dimension", arguments->dimension, "number of delay coordinates")->check(within(kCount, true));
  command
      ->add_option("--threshold", arguments->search.threshold,
                   "largest distance of a close return; 0: half the mean step, as S4")
      ->check(within(kNonNegative, false));
  command->add_option("--min-length", arguments->search.min_length, "shortest orbits, in samples")
      ->check(within(kCount, true));
  command
      ->add_option("--max-length", arguments->search.max_length,
                   "longest orbits, in samples; 0: a quarter of the series")
      ->check(within(kFromZero, true));
  command->add_option("-o,--output", arguments->output, "also store the orbits (HDF5)");
  command->footer(
      "Measured data have no equations to refine an orbit with; of a model 'orbit skeleton' finds true ones.\n"
      "Example:\n  slipmode orbit returns run.h5:trajectory/v --column 1 --delay 11 --dimension 6 -o returns.h5");
  return {command, [arguments](const Session&) { return run(*arguments); }};
}

}  // namespace slipmode::cli
