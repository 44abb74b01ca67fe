#include "cli/exponents_store.hpp"
#include "cli/text_table.hpp"
#include "results/table.hpp"

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

/// How many exponents a verdict shows.
constexpr Eigen::Index kVerdictExponents = 4;

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

std::string exponents_line(const ModelExponents& model, double unit, const std::string& unit_name) {
  const LyapunovSpectrum& spectrum = model.spectrum;
  if (!model.failure.empty()) return fmt::format("{}: failed: {}\n", model.name, model.failure);
  std::string text = fmt::format("{}: {}", model.name, spectrum.is_chaotic() ? "chaotic" : "not chaotic");
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

/// A line of the verdict.
struct VerdictRow {
  std::string name, unit;
  std::vector<Halved> values;  ///< one per model
};

/// @param of  what to take from a model that gave something
template <class Of>
VerdictRow verdict_row(const VerdictTable& verdict, std::string name, std::string unit, const Of& of) {
  VerdictRow out{.name = std::move(name), .unit = std::move(unit), .values = {}};
  for (const ModelFindings& model : verdict.models) out.values.push_back(model.failure.empty() ? of(model) : Halved{});
  return out;
}

Halved in_unit(const Halved& value, double factor) {
  return {.value = factor * value.value, .halves = {factor * value.halves[0], factor * value.halves[1]}};
}

std::vector<VerdictRow> verdict_rows(const VerdictTable& verdict, double unit, const std::string& unit_name) {
  std::vector<VerdictRow> out;
  for (Eigen::Index i = 0; i < kVerdictExponents; ++i) {
    out.push_back(verdict_row(verdict, fmt::format("exponent {}", i + 1), unit_name, [&](const ModelFindings& model) {
      const LyapunovSpectrum& spectrum = model.exponents;
      if (i >= spectrum.nats.size()) return Halved{};
      return in_unit({.value = spectrum.nats[i], .halves = {spectrum.halves(i, 0), spectrum.halves(i, 1)}}, unit);
    }));
  }
  out.push_back(verdict_row(verdict, "positive exponents", "", [](const ModelFindings& model) {
    const LyapunovSpectrum& spectrum = model.exponents;
    const auto count = [](const Eigen::ArrayXd& above) { return static_cast<double>((above > 0.0).count()); };
    const Eigen::ArrayXd four = 4.0 * spectrum.error.array();
    return Halved{
        .value = count(spectrum.nats.array() - four),
        .halves = {count(spectrum.halves.col(0).array() - four), count(spectrum.halves.col(1).array() - four)}};
  }));
  out.push_back(
      verdict_row(verdict, "Kaplan-Yorke dimension", "", [](const auto& model) { return model.kaplan_yorke; }));
  out.push_back(verdict_row(verdict, "correlation dimension", "", [](const auto& model) { return model.correlation; }));
  out.push_back(verdict_row(verdict, "delay", "samples", [](const auto& model) { return model.delay; }));
  out.push_back(verdict_row(verdict, "embedding dimension", "", [](const auto& model) { return model.embedding; }));
  out.push_back(verdict_row(verdict, "spectrum distance", "%",
                            [](const auto& model) { return in_unit(model.spectrum_distance, 100.0); }));
  out.push_back(verdict_row(verdict, "sticks", "% of the time",
                            [](const auto& model) { return in_unit(model.stick_fraction, 100.0); }));
  return out;
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

std::string exponents_text(const std::vector<ModelExponents>& models, bool bits) {
  const double unit = exponent_unit(bits);
  const std::string unit_name = bits ? "bit per unit of time" : "nat per unit of time";
  std::vector<std::string> header = {"exponent"};
  Eigen::Index rows = 0;
  for (const ModelExponents& model : models) {
    header.push_back(model.name);
    rows = std::max(rows, model.spectrum.nats.size());
  }
  TextTable table(header);
  for (Eigen::Index i = 0; i < rows; ++i) {
    std::vector<std::string> cells = {fmt::format("{}", i + 1)};
    for (const ModelExponents& model : models) cells.push_back(spectrum_cell(model.spectrum, i, unit));
    table.add(cells);
  }
  std::string text = fmt::format("Lyapunov exponents [{}] with standard errors\n{}", unit_name, table.str());
  for (const ModelExponents& model : models) text += exponents_line(model, unit, unit_name);
  return text;
}

std::string verdict_text(const VerdictTable& verdict, bool bits) {
  const std::string unit_name = bits ? "bit" : "nat";
  std::vector<std::string> header = {"figure"};
  for (const ModelFindings& model : verdict.models) header.push_back(model.name);
  TextTable table(header);
  for (const VerdictRow& row : verdict_rows(verdict, exponent_unit(bits), unit_name)) {
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
  const std::vector<VerdictRow> rows = verdict_rows(verdict, 1.0, "nat");
  for (std::size_t i = 0; i < verdict.models.size(); ++i) {
    const ModelFindings& model = verdict.models[i];
    Json one = {{"model", model.name}, {"degrees_of_freedom", model.modes}};
    if (!model.failure.empty()) one["failure"] = model.failure;
    for (const VerdictRow& row : rows) {
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

void store_verdict(results::StoreWriter& writer, const VerdictTable& verdict, const results::Units& units) {
  std::vector<std::string> model, name, unit;
  std::vector<double> value, first, second;
  for (const VerdictRow& row : verdict_rows(verdict, 1.0, "nat")) {
    for (std::size_t i = 0; i < row.values.size(); ++i) {
      model.push_back(verdict.models[i].name);
      name.push_back(row.name);
      unit.push_back(row.unit);
      value.push_back(row.values[i].value);
      first.push_back(row.values[i].halves[0]);
      second.push_back(row.values[i].halves[1]);
    }
  }
  results::save(writer, kVerdictGroup,
                results::Table{"one row per figure and model",
                               {{"model", {"", "which model"}, model},
                                {"figure", {"", "what it is"}, name},
                                {"unit", {"", "its unit"}, unit},
                                {"value", {"1", "from all data, in that unit"}, value},
                                {"first_half", {"1", "from the first half of the data"}, first},
                                {"second_half", {"1", "from the second half of the data"}, second}}});
  writer.write(std::string(kVerdictGroup) + "/sample", verdict.sample, {units.time, "interval of the records"});
  writer.write(std::string(kVerdictGroup) + "/channel", static_cast<std::int64_t>(verdict.channel + 1),
               {"", "degree of freedom whose velocity was recorded, from 1"});
}

}  // namespace slipmode::cli
