#include "cli/exponents_store.hpp"

#include "cli/json_values.hpp"
#include "results/table.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::cli {
namespace {

using diagnostics::LyapunovSpectrum;
using diagnostics::VolumeBalance;

void store_balance(results::StoreWriter& writer, const std::string& group, const VolumeBalance& balance,
                   const results::Units& units) {
  const std::string rate = units.rate;
  writer.write(group + "/viscous", balance.viscous, {rate, "mean of the trace of the field, dashpots"});
  writer.write(group + "/friction", balance.friction, {rate, "the same, friction that depends on sliding speed"});
  writer.write(group + "/events", balance.events, {rate, "logarithms of what events do to volumes, per time"});
  writer.write(group + "/revived", balance.revived, {rate, "growth of directions that slip gave back"});
  writer.write(group + "/expected", balance.expected(), {rate, "what the finite exponents must add up to"});
  writer.write(group + "/sum", balance.sum, {rate, "what they add up to"});
  writer.write(group + "/unexplained", static_cast<std::int64_t>(balance.unexplained),
               {"", "events that are not accounted for"});
}

void store_model_exponents(results::StoreWriter& writer, const std::string& group, const ModelExponents& model,
                           const results::Units& units) {
  const LyapunovSpectrum& spectrum = model.spectrum;
  writer.describe_group(group, "Lyapunov exponents of one model, from its tangent flow");
  writer.write(group + "/title", model.name, {"", "which model"});
  writer.write(group + "/failure", model.failure.empty() ? spectrum.failure : model.failure,
               {"", "why it ended early, or gave nothing; empty: it did not"});
  if (spectrum.nats.size() == 0) return;
  const Eigen::VectorXd bits = spectrum.bits();
  const Eigen::VectorXd first = spectrum.halves.col(0), second = spectrum.halves.col(1);
  results::save(
      writer, group + "/values",
      results::Table{"one row per exponent, descending",
                     {{"nats", {units.rate, "exponent; -inf: a direction that is lost"}, json_list(spectrum.nats)},
                      {"bits", {"bit per unit of time", "the same over ln 2"}, json_list(bits)},
                      {"error", {units.rate, "standard error, eight stretches"}, json_list(spectrum.error)},
                      {"first_half", {units.rate, "from the first half"}, json_list(first)},
                      {"second_half", {units.rate, "from the second half"}, json_list(second)}}});
  Eigen::VectorXd times(spectrum.rates.cols());
  for (Eigen::Index j = 0; j < times.size(); ++j) times[j] = spectrum.interval * static_cast<double>(j + 1);
  writer.write(group + "/time", times, {units.time, "ends of the intervals, from the start of measuring"});
  writer.write_columns(group + "/running", spectrum.running(), {units.rate, "exponents so far, time x exponent"});
  writer.write_columns(group + "/rates", spectrum.rates, {units.rate, "expansion per interval, time x exponent"});
  writer.write(group + "/directions", static_cast<std::int64_t>(spectrum.size), {"", "directions there are"});
  writer.write(group + "/lost", static_cast<std::int64_t>(spectrum.lost), {"", "exponents of minus infinity"});
  writer.write(group + "/kaplan_yorke", spectrum.dimension, {"1", "Kaplan-Yorke dimension"});
  writer.write(group + "/kaplan_yorke_error", spectrum.dimension_error, {"1", "its error"});
  if (spectrum.balance) store_balance(writer, group + "/balance", *spectrum.balance, units);
}

Json exponent_list(const Eigen::VectorXd& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(exponent_json(value));
  return out;
}

}  // namespace

Json exponent_json(double value) {
  if (std::isinf(value)) return value < 0.0 ? "-inf" : "inf";
  return json_number(value);
}

void store_exponents(results::StoreWriter& writer, const std::vector<ModelExponents>& models,
                     const results::Units& units) {
  for (std::size_t i = 0; i < models.size(); ++i)
    store_model_exponents(writer, fmt::format("{}/{}", kExponentsGroup, i), models[i], units);
}

Json exponents_json(const std::vector<ModelExponents>& models) {
  Json out = Json::array();
  for (const ModelExponents& model : models) {
    const LyapunovSpectrum& spectrum = model.spectrum;
    Json one = {{"model", model.name}};
    if (!model.failure.empty()) {
      one["failure"] = model.failure;
      out.push_back(one);
      continue;
    }
    one.update({{"nats", exponent_list(spectrum.nats)},
                {"bits", exponent_list(spectrum.bits())},
                {"error_nats", exponent_list(spectrum.error)},
                {"directions", spectrum.size},
                {"lost", spectrum.lost},
                {"chaotic", spectrum.is_chaotic()},
                {"kaplan_yorke", exponent_json(spectrum.dimension)},
                {"kaplan_yorke_error", exponent_json(spectrum.dimension_error)},
                {"duration", spectrum.duration},
                {"interval", spectrum.interval}});
    if (!spectrum.failure.empty()) one["ended_early"] = spectrum.failure;
    if (spectrum.balance) {
      const VolumeBalance& balance = *spectrum.balance;
      one["balance"] = {{"sum", balance.sum},
                        {"expected", balance.expected()},
                        {"viscous", balance.viscous},
                        {"friction", balance.friction},
                        {"events", balance.events},
                        {"revived", balance.revived},
                        {"unexplained", balance.unexplained}};
    }
    out.push_back(one);
  }
  return out;
}

std::vector<ModelExponents> exponents_of(const diagnostics::VerdictTable& verdict) {
  std::vector<ModelExponents> out;
  for (const diagnostics::ModelFindings& model : verdict.models)
    out.push_back({.name = model.name, .spectrum = model.exponents, .failure = model.failure});
  return out;
}

}  // namespace slipmode::cli
