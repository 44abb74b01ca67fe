#include <slipmode/results/exponents_store.hpp>

#include <slipmode/core/none.hpp>
#include <slipmode/results/table.hpp>
#include "results/internal/field_record.hpp"
#include "results/internal/journal_line.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::results {
namespace {

using diagnostics::Halved;
using diagnostics::LyapunovSpectrum;
using diagnostics::ModelFindings;
using diagnostics::VerdictTable;

void store_model_exponents(StoreWriter& writer, const std::string& group, const ModelExponents& model,
                           const Units& units) {
  const LyapunovSpectrum& spectrum = model.spectrum;
  writer.describe_group(group, "Lyapunov exponents of one model, from its tangent flow");
  writer.write(group + "/title", model.name, {"", "which model"});
  writer.write(group + "/failure", model.failure.empty() ? spectrum.failure : model.failure,
               {"", "why it ended early, or gave nothing; empty: it did not"});
  if (spectrum.nats.size() == 0) return;
  const Eigen::VectorXd bits = spectrum.bits();
  const Eigen::VectorXd first = spectrum.halves.col(0), second = spectrum.halves.col(1);
  save(writer, group + "/values",
       Table{"one row per exponent, descending",
             {{"nats", {units.rate, "exponent; -inf: a direction that is lost"}, values_of(spectrum.nats)},
              {"bits", {units.bit_rate(), "the same over ln 2"}, values_of(bits)},
              {"error", {units.rate, "standard error, eight stretches"}, values_of(spectrum.error)},
              {"first_half", {units.rate, "from the first half"}, values_of(first)},
              {"second_half", {units.rate, "from the second half"}, values_of(second)}}});
  Eigen::VectorXd times(spectrum.rates.cols());
  for (Eigen::Index j = 0; j < times.size(); ++j) times[j] = spectrum.interval * static_cast<double>(j + 1);
  writer.write(group + "/time", times, {units.time, "ends of the intervals, from the start of measuring"});
  writer.write_columns(group + "/running", spectrum.running(), {units.rate, "exponents so far, time x exponent"});
  writer.write_columns(group + "/rates", spectrum.rates, {units.rate, "expansion per interval, time x exponent"});
  save_fields(writer, group, spectrum);
  if (!spectrum.balance) return;
  save_fields(writer, group + "/balance", *spectrum.balance);
  writer.write(group + "/balance/expected", spectrum.balance->expected(),
               {units.rate, "what the finite exponents must add up to"});
}

/// How many exponents a verdict shows.
constexpr Eigen::Index kVerdictExponents = 4;

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

/// One row per exponent, one column per value.
Eigen::MatrixXd exponent_columns(const std::vector<ExponentPoint>& points, Eigen::VectorXd LeadingExponents::*part) {
  Eigen::Index rows = 0;
  for (const ExponentPoint& point : points) rows = std::max(rows, point.settled.nats.size());
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(rows, static_cast<Eigen::Index>(points.size()), kNone);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::VectorXd& values = points[i].settled.*part;
    out.col(static_cast<Eigen::Index>(i)).head(values.size()) = values;
  }
  return out;
}

}  // namespace

ExponentSink exponent_sink(Journal& journal) {
  return detail::table_sink<LeadingExponents>(journal, "exponents", [](detail::Line& line, ExponentPoint& point) {
    line(point.settled.nats, point.settled.error);
    if (!line.reads() && point.ok()) point.failure = point.settled.ended;
    if (line.reads() && point.settled.nats.size() > 0) point.settled.ended = std::exchange(point.failure, {});
  });
}

void store_exponent_sweep(StoreWriter& writer, const std::string& group, const std::string& title,
                          const SweepAxis& axis, const Units& units, const std::vector<ExponentPoint>& points) {
  std::vector<double> values;
  std::vector<std::string> failure;
  for (const ExponentPoint& point : points) {
    values.push_back(point.parameter);
    failure.push_back(point.ok() ? point.settled.ended : point.failure);
  }
  writer.describe_group(group, "leading Lyapunov exponents over a key: " + title);
  writer.write(group + "/title", title, {"", "which model"});
  writer.write(group + "/key", axis.key, {"", "the scene's key that was swept"});
  writer.write(group + "/label", axis.label, {"", "name of the key for an axis"});
  save(writer, group + "/values",
       Table{"one row per value of the key",
             {{"parameter", {axis.units, axis.key}, values},
              {"failure", {"", "why the value failed or ended early; empty: it did not"}, failure}}});
  writer.write_columns(group + "/nats", exponent_columns(points, &LeadingExponents::nats),
                       {units.rate, "exponents, value x exponent"});
  writer.write_columns(group + "/error", exponent_columns(points, &LeadingExponents::error),
                       {units.rate, "standard errors, value x exponent"});
}

void store_exponents(StoreWriter& writer, const std::vector<ModelExponents>& models, const Units& units) {
  for (std::size_t i = 0; i < models.size(); ++i)
    store_model_exponents(writer, fmt::format("{}/{}", kExponentsGroup, i), models[i], units);
}

std::vector<ModelExponents> exponents_of(const diagnostics::VerdictTable& verdict) {
  std::vector<ModelExponents> out;
  for (const diagnostics::ModelFindings& model : verdict.models)
    out.push_back({.name = model.name, .spectrum = model.exponents, .failure = model.failure});
  return out;
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
    const Eigen::ArrayXd four = diagnostics::kErrorsOfPositive * spectrum.error.array();
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

void store_verdict(StoreWriter& writer, const VerdictTable& verdict, const Units& units) {
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
  save(writer, kVerdictGroup,
       Table{"one row per figure and model",
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

}  // namespace slipmode::results
