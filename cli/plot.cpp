#include <slipmode/figures/file_figures.hpp>
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slipmode::cli {
namespace {

struct PlotArguments {
  std::string input, output, figure;
};

const figures::FileFigure& select(const std::vector<figures::FileFigure>& figures, const PlotArguments& arguments) {
  if (figures.empty()) {
    throw InvalidInput(
        fmt::format("'{}' holds nothing to draw ('slipmode info' says what is inside)", arguments.input));
  }
  if (arguments.figure.empty()) return figures.front();
  for (const figures::FileFigure& figure : figures) {
    if (figure.name == arguments.figure) return figure;
  }
  std::vector<std::string> names;
  for (const figures::FileFigure& figure : figures) names.push_back(figure.name);
  throw InvalidInput(
      fmt::format("--figure {}: '{}' can give {}", arguments.figure, arguments.input, fmt::join(names, ", ")));
}

Report run(const PlotArguments& arguments) {
  figures::require_figure_extension(arguments.output);
  require_writable(arguments.output);
  const results::StoreReader store(arguments.input);
  results::require_kind(store, figures::drawn_kinds());
  const std::vector<figures::FileFigure> figures = figures::figures_of(store);
  const figures::FileFigure& figure = select(figures, arguments);
  figures::save(figure.draw(store), {arguments.output});

  Report report;
  report.text = fmt::format("{}: {}\n", figure.what, arguments.output);
  Json others = Json::array();
  for (const figures::FileFigure& other : figures) {
    if (other.name == figure.name) continue;
    others.push_back(other.name);
    report.text += fmt::format("  also in this file: --figure {} ({})\n", other.name, other.what);
  }
  report.data = {{"verb", "plot"}, {"file", arguments.output}, {"figure", figure.name}, {"others", others}};
  return report;
}

}  // namespace

Verb add_plot(CLI::App& app) {
  CLI::App* command = app.add_subcommand("plot", "draw what a result file holds (svg, png or pdf)");
  const auto arguments = std::make_shared<PlotArguments>();
  command->add_option("FILE", arguments->input, "result file (HDF5)")->required();
  command->add_option("-o,--output", arguments->output, "figure; .svg, .png or .pdf chooses the format")->required();
  command->add_option("--figure", arguments->figure, "which figure, if the file can give several");
  command->footer(
      "Example:\n  slipmode plot sweep.h5 -o bifurcation.svg\n"
      "  slipmode plot out/chain10/pod.h5 --figure energy -o energy.png");
  return {.command = command, .run = [arguments](const Session&) { return run(*arguments); }, .reads_scene = false};
}

}  // namespace slipmode::cli
