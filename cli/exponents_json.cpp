#include <slipmode/results/table.hpp>
#include "cli/exponents_report.hpp"
#include "cli/json_values.hpp"

#include <cmath>

namespace slipmode::cli {
namespace {

using diagnostics::LyapunovSpectrum;

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

Json exponents_json(const std::vector<results::ModelExponents>& models) {
  Json out = Json::array();
  for (const results::ModelExponents& model : models) {
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
                {"chaotic", spectrum.is_chaotic()},
                {"undecided", spectrum.is_undecided()},
                {"duration", spectrum.duration},
                {"interval", spectrum.interval}});
    one.update(fields_json(spectrum));
    if (!spectrum.failure.empty()) one["ended_early"] = spectrum.failure;
    if (spectrum.balance) {
      one["balance"] = fields_json(*spectrum.balance);
      one["balance"]["expected"] = spectrum.balance->expected();
    }
    out.push_back(one);
  }
  return out;
}

}  // namespace slipmode::cli
