#include "cli/balance_report.hpp"

#include <slipmode/friction/places.hpp>
#include "cli/field_options.hpp"
#include "cli/json_values.hpp"
#include "cli/orbit_report.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {
namespace {

std::string coefficient_table(const std::vector<friction::Contact>& contacts, const orbits::Balance& balance) {
  constexpr int kShown = 15;
  const std::vector<std::vector<std::size_t>> places = friction::by_place(contacts);
  std::vector<std::string> header = {"order"};
  for (const std::vector<std::size_t>& place : places) {
    header.push_back(fmt::format("cosine {}", place.front() + 1));
    header.push_back(fmt::format("sine {}", place.front() + 1));
  }
  TextTable table(header);
  for (int k = 0; k <= std::min(balance.harmonics, kShown); ++k) {
    std::vector<std::string> row = {std::to_string(k)};
    for (const std::vector<std::size_t>& place : places) {
      const orbits::Harmonics& own = balance.displacement[place.front()];
      row.push_back(fmt::format("{:.8g}", own.cosine[k]));
      row.push_back(fmt::format("{:.8g}", own.sine[k]));
    }
    table.add(std::move(row));
  }
  return table.str();
}

/// Orders that were tried, where one was chosen.
void add_trials(const std::vector<orbits::OrderTrial>& trials, bool converged, bool met, Report& out_report) {
  if (trials.empty()) return;
  out_report.data["trials"] = Json::array();
  for (const orbits::OrderTrial& trial : trials) out_report.data["trials"].push_back(fields_json(trial));
  if (!converged || met) return;
  out_report.exit_code = kNumericalFailure;
  out_report.data["message"] = studies::not_met(trials);
  out_report.text += studies::not_met(trials) + "\n";
}

void add_certificate(const studies::Family& model, const orbits::Certificate& own, Report& out_report) {
  out_report.data["certificate"] = {{"behind", own.behind},
                                    {"verdict", own.verdict},
                                    {"error", own.error},
                                    {"relative", own.error.empty() ? Json(nullptr) : json_number(own.relative)}};
  out_report.text += fmt::format("Certificate: {}\n", own.verdict);
  if (own.found.converged()) {
    const auto amplitudes = orbits::contact_amplitudes(model.own(), own.found.orbit);
    out_report.data["certificate"]["orbit"] = orbit_json(model.own(), own.found.orbit, amplitudes);
    out_report.text += fmt::format("  as good as the location of events is: docs/limits.md has what is open there\n{}",
                                   orbit_text(model.own(), own.found.orbit, amplitudes));
  }
}

}  // namespace

void add_balance_options(CLI::App& command, BalanceArguments& out_arguments, const std::vector<std::string>& ways) {
  command
      .add_option("--by", out_arguments.by,
                  "shooting (exact), balance: truncated Fourier series of the contacts, or mixed: contacts in the time "
                  "domain, the rest in series (orbit find)")
      ->check(CLI::IsMember(ways));
  add_fields(command, out_arguments.words);
}

void require_no_balance_options(const BalanceArguments& arguments) {
  if (arguments.words != studies::BalanceWords{})
    throw InvalidInput(
        "--harmonics, --error, --samples, --near, --certify: of an approximation; add --by balance or "
        "--by mixed");
}

Report mixed_report(const studies::Family& model, const studies::MixedFound& found) {
  const orbits::MixedOrbit& mixed = found.mixed;
  const dynamics::HybridSystem& system = model.own();
  Report report;
  report.exit_code = mixed.converged ? kDone : kNumericalFailure;
  report.data =
      merged({{"verb", "orbit find"}, {"title", model.scene().title}, {"model", model.title()}}, fields_json(mixed));
  report.data["by"] = "mixed";
  report.data["near"] = studies::near_names(model, mixed);
  report.text = fmt::format(
      "{}, {}: {} of {} degrees of freedom in the time domain, the rest in {} harmonics of {:.10g} rad/s\n"
      "  residual {:.1e} after {} Newton steps\n",
      model.scene().name(), model.title(), mixed.near.size(), system.size(), mixed.harmonics, mixed.omega,
      mixed.residual, mixed.iterations);
  if (!mixed.converged) {
    report.data["message"] = mixed.message;
    add_trials(found.trials, mixed.converged, found.met, report);
    report.text += mixed.message + "\n";
    return report;
  }
  const std::vector<orbits::Amplitude> amplitudes = orbits::contact_amplitudes(*mixed.near_system, mixed.near_orbit);
  report.data["word"] = mixed.near_orbit.word;
  report.text +=
      fmt::format("  word \"{}\", {} crossings\n", orbits::abridged(mixed.near_orbit.word), mixed.near_orbit.crossings);
  Json contacts = Json::array();
  for (std::size_t c = 0; c < amplitudes.size(); ++c) {
    const orbits::Amplitude& own = amplitudes[c];
    contacts.push_back(
        {{"contact", system.contacts()[c].name}, {"min", own.min}, {"max", own.max}, {"mean", own.mean}});
    report.text += fmt::format("  contact {}: from {:.9g} to {:.9g}, mean {:.9g}\n", c + 1, own.min, own.max, own.mean);
  }
  report.data["contacts"] = contacts;
  add_trials(found.trials, mixed.converged, found.met, report);
  if (found.certificate)
    add_certificate(model, *found.certificate, report);
  else
    report.text += "  stability and true error: by --certify, which shoots on the whole structure\n";
  return report;
}

Report balance_report(const std::string& verb, const studies::Family& model, const studies::BalanceFound& found) {
  const orbits::Balance& balance = found.balance;
  Report report;
  report.exit_code = balance.converged ? kDone : kNumericalFailure;
  report.data =
      merged({{"verb", verb}, {"title", model.scene().title}, {"model", model.title()}}, fields_json(balance));
  report.data["by"] = "balance";
  Json contacts = Json::array();
  for (std::size_t c = 0; c < balance.displacement.size(); ++c) {
    contacts.push_back({{"contact", model.own().contacts()[c].name},
                        {"displacement", harmonics_json(balance.displacement[c])},
                        {"force", harmonics_json(balance.force[c])}});
  }
  report.data["contacts"] = contacts;
  const std::string forces = balance.samples == 0 ? "exact forces" : fmt::format("{} samples", balance.samples);
  report.text = fmt::format(
      "{}, {}: balance of {} harmonics by {}, order 1 at {:.10g} rad/s{}\n  {} switches of contact, "
      "residual {:.1e} after {} Newton steps\n",
      model.scene().name(), model.title(), balance.harmonics, forces, balance.omega,
      balance.family ? ", one of a family that nothing holds" : "", balance.switches, balance.residual,
      balance.iterations);
  if (!balance.converged) report.text += balance.message + "\n";
  if (balance.converged) report.text += coefficient_table(model.own().contacts(), balance);
  if (found.hill.size() > 0) {
    report.data["hill"] = {{"multipliers", complex_json(found.hill)},
                           {"without_jumps", complex_json(found.hill_without_jumps)}};
    report.text += fmt::format("  multipliers by Hill's method {}", multipliers_text(found.hill));
    if (found.hill != found.hill_without_jumps)
      report.text += fmt::format("; were the jumps at stops left out, {}", multipliers_text(found.hill_without_jumps));
    report.text += "\n";
  }
  if (balance.converged && orbits::has_memory(model.own())) {
    constexpr const char* kWhy =
        "multipliers: none by Hill's method, which does not hold where friction has a contact spring; by --certify";
    report.data["hill"] = {{"multipliers", nullptr}, {"message", kWhy}};
    report.text += fmt::format("  {}\n", kWhy);
  }
  if (balance.converged && balance.stuck > 0) {
    report.text += fmt::format(
        "  {} of {} contacts never slide: where the slider stands the motion does not tell, the place nearest to 0 is "
        "taken\n",
        balance.stuck, balance.displacement.size());
  }
  add_trials(found.trials, balance.converged, found.met, report);
  if (!balance.converged) report.data["message"] = balance.message;
  if (found.certificate) add_certificate(model, *found.certificate, report);
  return report;
}

}  // namespace slipmode::cli
