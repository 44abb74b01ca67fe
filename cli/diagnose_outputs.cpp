#include "cli/diagnose.hpp"

#include <slipmode/figures/file_figures.hpp>
#include <slipmode/figures/gnuplot.hpp>

#include <fmt/format.h>
#include <filesystem>

namespace slipmode::cli {

namespace {

std::string file_in(const std::string& figures) { return (std::filesystem::path(figures) / "diagnosis.h5").string(); }

}  // namespace

std::string diagnosis_file(const DiagnoseRequest& request) {
  return request.output.empty() && !request.figures.empty() ? file_in(request.figures) : request.output;
}

void check_diagnosis_outputs(const DiagnoseRequest& request) {
  if (!request.output.empty()) require_writable(request.output);
  if (request.figures.empty()) return;
  figures::require_gnuplot();
  std::filesystem::create_directories(request.figures);
  require_writable(file_in(request.figures));
}

void draw_diagnosis(const DiagnoseRequest& request, const std::string& file, Report& out_report) {
  if (request.figures.empty()) return;
  const results::StoreReader store(file);
  out_report.data["figures"] = figures::save_all(store, figures::figures_of(store), request.figures);
  out_report.text += fmt::format("Figures: {}\n", request.figures);
}

}  // namespace slipmode::cli
