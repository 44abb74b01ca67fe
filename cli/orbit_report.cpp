#include "cli/orbit_report.hpp"

#include <slipmode/friction/places.hpp>
#include <slipmode/results/table.hpp>
#include "cli/json_values.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <cmath>
#include <complex>

namespace slipmode::cli {
namespace {

using orbits::PeriodicOrbit;

/// Imaginary parts below this, relative, are a pair's rounding.
constexpr double kReal = 1e-12;

std::string contact_name(const dynamics::HybridSystem& system, std::size_t c) {
  const std::string& name = system.contacts()[c].name;
  return name.empty() ? fmt::format("contact {}", c + 1) : name;
}

std::string period_text(const PeriodicOrbit& orbit) {
  std::string text = fmt::format("{} orbit, period {:.12g}", orbits::to_string(orbit.kind), orbit.period);
  if (orbit.kind == orbits::OrbitKind::kDriven) {
    text += orbit.order == 1 ? " (the drive's)" : fmt::format(" ({} of the drive's)", orbit.order);
  }
  if (orbit.repeats > 1) text += fmt::format(", a shorter orbit {} times", orbit.repeats);
  return text;
}

std::string stability_text(const PeriodicOrbit& orbit) {
  std::string text =
      fmt::format("{}, leading |multiplier| {:.8g}", orbits::to_string(orbit.stability), orbit.leading_modulus);
  if (orbit.trivial_multipliers > 0) text += fmt::format(" besides {} trivial", orbit.trivial_multipliers);
  if (orbit.superstable) {
    text += ", superstable";
  } else if (orbit.zero_multipliers > 0) {
    text += fmt::format(", {} zero", orbit.zero_multipliers);
  }
  return text;
}

std::string word_text(const PeriodicOrbit& orbit) {
  return fmt::format("{} ({} crossings{}{})", orbits::abridged(orbit.word), orbit.crossings,
                     orbit.symmetric ? ", symmetric" : "", orbit.has_grazing ? ", grazing" : "");
}

std::string amplitude_table(const dynamics::HybridSystem& system, const std::vector<orbits::Amplitude>& amplitudes) {
  TextTable table({"contact", "least", "greatest", "mean", "alternating", "effective"});
  for (const std::vector<std::size_t>& place : friction::by_place(system.contacts())) {
    const orbits::Amplitude& own = amplitudes[place.front()];
    std::string name = contact_name(system, place.front());
    if (place.size() > 1) name += fmt::format(", and {} more there", place.size() - 1);
    std::vector<std::string> row = {std::move(name)};
    for (const double value : {own.min, own.max, own.mean, own.alternating, own.effective}) {
      row.push_back(fmt::format("{:.10g}", value));
    }
    table.add(std::move(row));
  }
  return table.str();
}

}  // namespace

std::string multipliers_text(const Eigen::VectorXcd& multipliers) {
  constexpr std::size_t kShown = 6;
  std::vector<std::string> texts;
  for (Eigen::Index k = 0; k < multipliers.size() && texts.size() < kShown; ++k) {
    const double re = multipliers[k].real(), im = multipliers[k].imag();
    if (std::abs(im) <= kReal * std::abs(re)) {
      texts.push_back(fmt::format("{:.8g}", re));
    } else if (im > 0.0) {  // its conjugate follows
      texts.push_back(fmt::format("{:.8g} ± {:.8g}i", re, im));
    }
  }
  const bool more = multipliers.size() > static_cast<Eigen::Index>(kShown);
  return fmt::format("{}{}", fmt::join(texts, ", "), more ? ", ..." : "");
}

Json complex_json(const Eigen::VectorXcd& values) {
  Json pairs = Json::array();
  for (const std::complex<double>& value : values) pairs.push_back({value.real(), value.imag()});
  return pairs;
}

Json orbit_json(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit,
                const std::vector<orbits::Amplitude>& amplitudes) {
  Json data = {{"kind", orbits::to_string(orbit.kind)},
               {"multipliers", complex_json(orbit.multipliers)},
               {"stability", orbits::to_string(orbit.stability)},
               {"half_multipliers", complex_json(orbit.half_multipliers)},
               {"family_dimension", orbit.family.cols()}};
  data.update(fields_json(orbit));
  data["start"] = {{"time", orbit.start.time},
                   {"displacement", results::values_of(orbit.start.q)},
                   {"velocity", results::values_of(orbit.start.v)},
                   {"internal", results::values_of(orbit.start.internal)}};
  Json sizes = Json::array();
  for (std::size_t c = 0; c < amplitudes.size(); ++c)
    sizes.push_back(merged({{"contact", contact_name(system, c)}}, fields_json(amplitudes[c])));
  data["amplitudes"] = sizes;
  return data;
}

std::string orbit_text(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit,
                       const std::vector<orbits::Amplitude>& amplitudes) {
  std::string text = fmt::format(
      "{}\n  stability    {}\n  multipliers  {}\n  regimes      {}\n  mismatch     {:.2g} after {} Newton steps\n",
      period_text(orbit), stability_text(orbit), multipliers_text(orbit.multipliers), word_text(orbit), orbit.residual,
      orbit.iterations);
  if (!orbit.family_note.empty()) text += fmt::format("  family       {}\n", orbit.family_note);
  return text + amplitude_table(system, amplitudes);
}

void fail_with(Report& out_report, int exit_code, const std::string& message) {
  out_report.exit_code = exit_code;
  out_report.text = message + "\n" + out_report.text;
  out_report.data["message"] = message;
}

void incomplete(Report& out_report, int exit_code, const std::string& message) {
  fail_with(out_report, exit_code, message);
  out_report.data["incomplete"] = true;
}

Report not_found(const std::string& verb, const orbits::ShootingResult& result) {
  const orbits::PeriodicOrbit& best = result.orbit;
  Report report;
  report.exit_code = kNumericalFailure;
  report.text = fmt::format("no orbit from this guess ({}): {}", orbits::to_string(result.status), result.message);
  report.data = {
      {"verb", verb},
      {"message", report.text},
      {"reason", orbits::to_string(result.status)},
      {"period", best.period},
      {"residual", best.residual},
      {"iterations", best.iterations},
      {"residuals", best.residuals},
      {"best", {{"displacement", results::values_of(best.start.q)}, {"velocity", results::values_of(best.start.v)}}}};
  return report;
}

}  // namespace slipmode::cli
