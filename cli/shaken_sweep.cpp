#include <slipmode/results/driven_store.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/reduced_file.hpp>
#include <slipmode/rom/reduce.hpp>
#include "cli/shaken_bases.hpp"
#include "cli/shaken_model.hpp"
#include "cli/steps.hpp"
#include "cli/sweep_report.hpp"
#include "cli/sweep_request.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>

namespace slipmode::cli {
namespace {

/// The model swept, where it starts, and what identifies it for resuming.
struct ShakenSubject {
  std::optional<pod::Basis> basis;
  std::string title, identity = "full";
};

std::string basis_identity(const pod::Basis& basis) {
  const std::string bytes(reinterpret_cast<const char*>(basis.vectors.data()),
                          static_cast<std::size_t>(basis.vectors.size()) * sizeof(double));
  return results::fingerprint(bytes);
}

/// "pomf:3": a basis of the scene's own words, made as its ensemble says.
ShakenSubject basis_subject(const Session& session, const scene::Scene& scene, const dynamics::HybridSystem& system,
                            const std::string& model) {
  const std::size_t colon = model.find(':');
  const std::string word = model.substr(0, colon);
  Eigen::Index modes = 0;
  const char* end = model.data() + model.size();
  const bool counted = colon != std::string::npos && colon + 1 < model.size();
  const auto parsed = counted ? std::from_chars(model.data() + colon + 1, end, modes) : std::from_chars_result{};
  for (const auto choice : {scene::BasisChoice::kPom, scene::BasisChoice::kLnm, scene::BasisChoice::kPomf,
                            scene::BasisChoice::kMassPom, scene::BasisChoice::kLnmStatic}) {
    if (scene::to_string(choice) != word) continue;
    if (!counted || parsed.ec != std::errc() || parsed.ptr != end || modes < 1) break;
    std::optional<ShakenModes> made;
    const pod::Basis basis = shaken_basis(choice, scene, system, [&]() -> const ShakenModes& {
      made = shaken_modes(scene, system.structure(), run_scene_ensemble(session, scene, system).ensemble);
      return *made;
    });
    if (modes > basis.modes()) {
      throw InvalidInput(
          fmt::format("--model {}: there are {} such modes; valid: 1 to {}", model, basis.modes(), basis.modes()));
    }
    const pod::Basis kept = basis.truncated(modes);
    return {.basis = kept,
            .title = fmt::format("reduced model, {} modes ({})", modes, word),
            .identity = basis_identity(kept)};
  }
  throw InvalidInput(
      fmt::format("--model {}: expected full, rom:FILE with a result of 'slipmode reduce', or BASIS:L with pomf, lnm, "
                  "lnm+static or mass-pom, e.g. pomf:3",
                  model));
}

ShakenSubject subject(const Session& session, const scene::Scene& scene, const dynamics::HybridSystem& system,
                      const std::string& model) {
  if (model == "full") {
    return {.basis = {}, .title = fmt::format("full model, {} degrees of freedom", system.size())};
  }
  const std::optional<std::string> file = results::reduced_file(model);
  if (!file) return basis_subject(session, scene, system, model);
  const pod::Basis basis = results::reduced_basis(*file, system.size());
  return {.basis = basis,
          .title = fmt::format("reduced model, {} modes", basis.modes()),
          .identity = "rom " + file_fingerprint(*file)};
}

/// The shaker's frequency is special: modal data are then shared by all values.
diagnostics::DrivenModel model_over(const scene::Scene& scene, const std::string& key,
                                    const std::optional<pod::Basis>& basis) {
  const auto projected = [basis](const diagnostics::DrivenCase& full) {
    return basis ? diagnostics::reduced_case(full, *basis) : full;
  };
  if (key == "drive.frequency") return driven_model(projected(shaken_case(scene)), drive_over_frequency(scene));
  return [=](double value) { return projected(shaken_case(scene::set_key(scene, key, value))); };
}

struct Pass {
  std::vector<diagnostics::DrivenPoint> up, down;
  bool interrupted = false;
};

Report summary(const SweepRequest& request, const ShakenSubject& swept, const Over& over, const Pass& found) {
  const auto& points = found.up.empty() ? found.down : found.up;
  Report report;
  const MotionTable motions = motion_table(results::count_motions(points), points.size());
  double audit = 0.0;
  for (const auto& point : points)
    if (point.ok()) audit = std::max(audit, std::abs(point.settled.audit_residual));
  const Json failures = failures_of(points);
  Json peaks = Json::array();
  const auto highest = diagnostics::amplitude_peaks(points);
  for (const auto& peak : highest) peaks.push_back({{"value", peak.parameter}, {"amplitude", peak.amplitude}});
  report.data = {{"verb", "sweep"},
                 {"file", request.output},
                 {"model", swept.title},
                 {"key", over.key},
                 {"values", points.size()},
                 {"motions", motions.json},
                 {"largest_audit_residual", audit},
                 {"peaks", peaks},
                 {"failures", failures}};
  report.text =
      fmt::format("{}: {} values of {}, largest energy residual {:.1e}\n{}peaks of the amplitude at {}\n", swept.title,
                  points.size(), over.key, audit, motions.text.str(), results::peaks_text(highest));
  if (request.both) {
    const double share = diagnostics::hysteresis(found.up, found.down);
    report.data["hysteresis"] = share;
    report.text += fmt::format("up and down differ at {:.1f} % of the values\n", 100.0 * share);
  }
  report.text += fmt::format("Sweep: {}\n", request.output);
  report_failures(report, failures, points.size());
  return report;
}

}  // namespace

Report run_shaken_sweep(const Session& session, const SweepRequest& request, const Over& over,
                        const scene::Scene& scene) {
  if (request.both && !request.follow) {
    throw InvalidInput("--both: without --follow every value starts alike, and up and down are the same; add --follow");
  }
  check_values(scene, over);
  const diagnostics::DrivenCase full = shaken_case(scene);
  const ShakenSubject swept = subject(session, scene, full.system, request.model);
  const std::string manner =
      fmt::format("{}{}{}{}", request.follow ? fmt::format(" --follow --segments {}", request.segments) : "",
                  request.reverse ? " --reverse" : "", request.both ? " --both" : "",
                  request.exponent_cycles > 0.0 ? fmt::format(" --lyapunov {}", request.exponent_cycles) : "");
  const std::string task = fmt::format("slipmode sweep --over {} --model {}{}", request.over, request.model, manner);
  const std::string identity = results::fingerprint(
      fmt::format("{}\n{}\n{}\n{}", results::version(), task, swept.identity, scene::scene_to_toml(scene)));
  results::Journal journal(results::Journal::path_for(request.output), identity);
  const std::size_t resumed = journal.records().size();

  const dynamics::State start = scene::initial_state(scene, full.system);
  const dynamics::State begin = swept.basis ? rom::restrict_state(full.system.structure(), *swept.basis, start) : start;
  ProgressLine line("sweep", session.progress_mode());
  diagnostics::DrivenSweepOptions options{
      .mode = request.follow ? diagnostics::SweepMode::kFollow : diagnostics::SweepMode::kIndependent,
      .segments = request.segments,
      .driven = driven_options(scene),
      .parallel = session.parallel(line),
      .sink = results::driven_journal_sink(journal)};
  options.driven.exponent_cycles = request.exponent_cycles;
  const diagnostics::DrivenModel model = model_over(scene, over.key, swept.basis);
  Pass found;
  const auto pass = [&](const std::vector<double>& values, int tag) {
    if (found.interrupted) return std::vector<diagnostics::DrivenPoint>();
    options.model = tag;
    diagnostics::DrivenSweep one = diagnostics::driven_sweep(model, values, begin, options);
    found.interrupted = one.interrupted;
    return std::move(one.points);
  };
  const std::vector<double> reversed(over.values.rbegin(), over.values.rend());
  if (!request.reverse) found.up = pass(over.values, 0);
  if (request.reverse || request.both) found.down = pass(reversed, 1);
  if (found.interrupted) return interrupted_sweep(request, over, journal.records().size());

  const results::Units units = results::Units::of(scene.units);
  const results::DrivenAxes axes{results::sweep_axis(scene, over.key), reading_name(scene), reading_unit(scene)};
  const std::string group = swept.basis ? "sweep/reduced" : "sweep/full";
  results::StoreWriter writer(request.output, scene.units);
  results::save(writer, results::provenance_of(scene, task));
  const std::string up_title = request.both ? swept.title + ", upward" : swept.title;
  if (!found.up.empty()) results::store_driven(writer, group, up_title, axes, units, found.up);
  if (!found.down.empty())
    results::store_driven(writer, group + "_reverse", swept.title + ", downward", axes, units, found.down);
  writer.commit();
  journal.remove();
  Report report = summary(request, swept, over, found);
  report.data["resumed"] = resumed;
  if (resumed > 0) report.text += fmt::format("{} values were taken over from an interrupted run\n", resumed);
  return report;
}

}  // namespace slipmode::cli
