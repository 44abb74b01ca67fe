#include <slipmode/results/table.hpp>
#include "cli/exponents_report.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::cli {
namespace {

using diagnostics::Halved;
using diagnostics::LyapunovSpectrum;
using diagnostics::ModelFindings;
using diagnostics::VerdictTable;

double exponent_unit(bool bits) { return bits ? 1.0 / std::numbers::ln2 : 1.0; }

/// Digits after the point that show the second one of the error.
int digits_for(double error) {
  if (!(error > 0.0) || !std::isfinite(error)) return 6;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(error))), 0, 9);
}

std::string exponent_text(double value, double error) {
  if (std::isinf(value)) return "-inf";
  if (std::isnan(value)) return "–";
  if (std::isnan(error)) return fmt::format("{:.4g}", value);
  const int digits = digits_for(error);
  return fmt::format("{:.{}f} ± {:.{}f}", value, digits, error, digits);
}

std::string spectrum_cell(const LyapunovSpectrum& spectrum, Eigen::Index i, double unit) {
  if (i >= spectrum.nats.size()) return "";
  return exponent_text(unit * spectrum.nats[i], unit * spectrum.error[i]);
}

std::string exponents_line(const results::ModelExponents& model, double unit, const std::string& unit_name) {
  const LyapunovSpectrum& spectrum = model.spectrum;
  if (!model.failure.empty()) return fmt::format("{}: failed: {}\n", model.name, model.failure);
  const char* verdict = spectrum.is_chaotic() ? "chaotic"
                        : spectrum.is_undecided()
                            ? "undecided (the largest exponent is not four errors above zero; --duration)"
                            : "not chaotic";
  std::string text = fmt::format("{}: {}", model.name, verdict);
  text += fmt::format("; Kaplan-Yorke dimension {}", exponent_text(spectrum.dimension, spectrum.dimension_error));
  if (spectrum.lost > 0) text += fmt::format("; {} of {} directions lost in stick", spectrum.lost, spectrum.size);
  text += "\n";
  if (spectrum.balance) {
    const auto& balance = *spectrum.balance;
    text += fmt::format("  sum of the finite ones {:.6f}, by divergence and events {:.6f} {}", unit * balance.sum,
                        unit * balance.expected(), unit_name);
    text += balance.unexplained > 0 ? fmt::format(" ({} events not accounted for)\n", balance.unexplained) : "\n";
  }
  if (!spectrum.failure.empty()) text += fmt::format("  ended after {:g}: {}\n", spectrum.duration, spectrum.failure);
  return text;
}

std::string halved_cell(const Halved& value) {
  const bool whole =
      value.value == std::round(value.value) && (value.spread() == std::round(2.0 * value.spread()) / 2.0);
  if (whole && !std::isinf(value.value)) {
    const bool known = !std::isnan(value.spread());
    return known ? fmt::format("{:g} ± {:g}", value.value, value.spread()) : fmt::format("{:g}", value.value);
  }
  return exponent_text(value.value, value.spread());
}

}  // namespace

std::string exponents_text(const std::vector<results::ModelExponents>& models, bool bits, const results::Units& units) {
  const double unit = exponent_unit(bits);
  const std::string unit_name = fmt::format("{} per {}", bits ? "bit" : "nat", units.one_time());
  std::vector<std::string> header = {"exponent"};
  Eigen::Index rows = 0;
  for (const results::ModelExponents& model : models) {
    header.push_back(model.name);
    rows = std::max(rows, model.spectrum.nats.size());
  }
  TextTable table(header);
  for (Eigen::Index i = 0; i < rows; ++i) {
    std::vector<std::string> cells = {fmt::format("{}", i + 1)};
    for (const results::ModelExponents& model : models) cells.push_back(spectrum_cell(model.spectrum, i, unit));
    table.add(cells);
  }
  std::string text = fmt::format("Lyapunov exponents [{}] with standard errors\n{}", unit_name, table.str());
  for (const results::ModelExponents& model : models) text += exponents_line(model, unit, unit_name);
  return text;
}

std::string verdict_text(const VerdictTable& verdict, bool bits) {
  const std::string unit_name = bits ? "bit" : "nat";
  std::vector<std::string> header = {"figure"};
  for (const ModelFindings& model : verdict.models) header.push_back(model.name);
  TextTable table(header);
  for (const results::VerdictRow& row : results::verdict_rows(verdict, exponent_unit(bits), unit_name)) {
    std::vector<std::string> cells = {row.unit.empty() ? row.name : fmt::format("{} [{}]", row.name, row.unit)};
    for (const Halved& value : row.values) cells.push_back(halved_cell(value));
    table.add(cells);
  }
  std::string text = fmt::format(
      "Verdict: every model by itself; ± half the difference between the two halves of its data\n{}"
      "  record: velocity of degree of freedom {}, every {:g}; spectrum distance of the full model: between its "
      "halves\n",
      table.str(), verdict.channel + 1, verdict.sample);
  for (const ModelFindings& model : verdict.models) {
    if (!model.failure.empty()) text += fmt::format("  {} failed: {}\n", model.name, model.failure);
    for (const std::string& note : model.notes) text += fmt::format("  {}: {}\n", model.name, note);
  }
  return text;
}

Json verdict_json(const VerdictTable& verdict) {
  Json out = {{"channel", verdict.channel + 1}, {"sample", verdict.sample}};
  const std::vector<results::VerdictRow> rows = results::verdict_rows(verdict, 1.0, "nat");
  for (std::size_t i = 0; i < verdict.models.size(); ++i) {
    const ModelFindings& model = verdict.models[i];
    Json one = {{"model", model.name}, {"degrees_of_freedom", model.modes}};
    if (!model.failure.empty()) one["failure"] = model.failure;
    for (const results::VerdictRow& row : rows) {
      const Halved& value = row.values[i];
      one["figures"][row.name] = {{"value", exponent_json(value.value)},
                                  {"halves", {exponent_json(value.halves[0]), exponent_json(value.halves[1])}},
                                  {"unit", row.unit}};
    }
    one["notes"] = model.notes;
    out["models"].push_back(one);
  }
  return out;
}

}  // namespace slipmode::cli
