#include <slipmode/studies/motions.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/results/driven_store.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/driven.hpp>
#include <slipmode/scene/solver_options.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace slipmode::studies {
namespace {

using diagnostics::Model;
using dynamics::Event;

/// Times that all models share.
struct MotionTimes {
  double interval = 0.0, lead = 0.0, kept = 0.0, spectrum = 0.0, highest_hz = 0.0;

  /// @param period   of which the request counts @param highest_hz  that a spectrum shows
  MotionTimes(double period, double highest, const MotionsRequest& request)
      : interval(request.periods * period / static_cast<double>(request.samples - 1)),
        lead(2.0 * period),
        kept(request.periods * period),
        spectrum(request.spectrum_periods * period),
        highest_hz(highest) {}
};

/// Natural frequencies of the full structure, up to twenty [Hz]: those that vibrate.
std::vector<double> natural_hz(const dynamics::HybridSystem& full) {
  constexpr Eigen::Index kResolved = 20;
  std::vector<double> hz;
  for (const double omega : fem::natural_modes(full.structure(), std::min(kResolved, full.size())).omega)
    if (omega > 0.0) hz.push_back(omega / (2.0 * std::numbers::pi));
  return hz;
}
constexpr double kAboveModes = 1.3;  ///< of the highest of these: shown

/// Time from the start to the first contact's slip from the largest displacement within the lead; 0: it does not slip.
double time_to_slip(const dynamics::HybridSystem& system, const dynamics::State& start, const MotionTimes& times) {
  const dynamics::Trajectory run = dynamics::simulate(system, start,
                                                      {.duration = times.lead,
                                                       .sample = times.lead,
                                                       .output = dynamics::SimulateOptions::Output::kContacts,
                                                       .flow = {.audit = false}});
  const Event* begin = nullptr;
  for (const Event& event : run.events) {
    const bool slips = event.contact == 0 && event.kind == dynamics::EventKind::kRelease;
    if (slips && (begin == nullptr || event.displacement > begin->displacement)) begin = &event;
  }
  return begin == nullptr ? 0.0 : begin->time - start.time;
}

/// @param basis  of a reduced model, else null @param lead  from the start to what is kept
Motion recorded(const dynamics::HybridSystem& system, const pod::Basis* basis, const dynamics::State& from, double lead,
                const MotionsRequest& request, const MotionTimes& times) {
  const dynamics::Trajectory run = dynamics::simulate(system, from,
                                                      {.duration = lead + times.kept + 0.5 * times.interval,
                                                       .transient = lead,
                                                       .sample = times.interval,
                                                       .flow = {.audit = false}});
  const Eigen::Index count = std::min(request.samples, run.times.size());
  Motion motion{.interval = times.interval,
                .q = run.contact_q.leftCols(count),
                .v = run.contact_v.leftCols(count),
                .lambda = run.lambda.leftCols(count),
                .shape = {},
                .events = {},
                .modes = run.final_state.modes,
                .spectrum = {}};
  const Eigen::Index shapes = (count + request.samples_per_shape - 1) / request.samples_per_shape;
  const Eigen::MatrixXd q = run.q(Eigen::all, Eigen::seqN(0, shapes, request.samples_per_shape));
  motion.shape =
      basis != nullptr
          ? Eigen::MatrixXd((request.readings * basis->vectors * q).colwise() + request.readings * basis->mean)
          : Eigen::MatrixXd(request.readings * q);
  for (Event event : run.events) {
    event.time -= run.times[0];
    motion.events.push_back(event);
  }
  const double sample = std::min(2.0 * times.interval, 0.4 / times.highest_hz);
  const dynamics::Trajectory longer = dynamics::simulate(system, from,
                                                         {.duration = times.spectrum,
                                                          .sample = sample,
                                                          .keep_events = false,
                                                          .output = dynamics::SimulateOptions::Output::kContacts,
                                                          .flow = {.audit = false}});
  motion.spectrum = diagnostics::amplitude_spectrum(longer.contact_v.row(0).transpose(), sample);
  Eigen::Index shown = 1;
  while (shown < motion.spectrum.frequency_hz.size() && motion.spectrum.frequency_hz[shown] < times.highest_hz) ++shown;
  motion.spectrum.frequency_hz.conservativeResize(shown);
  motion.spectrum.amplitude.conservativeResize(shown);
  return motion;
}

/// The motions that are kept. @param at  the motion at the k-th value; empty where none was settled to
void record(const MotionsRequest& request, const StopFlag* stop,
            const std::function<std::optional<Motion>(std::size_t)>& at, MotionsOf& out) {
  for (std::size_t k = 0; k < request.values.size(); ++k) {
    if (!request.recorded[k]) continue;
    if (stop != nullptr && stop->load()) throw Interrupted();
    std::optional<Motion>& motion = out.motions.emplace_back();
    try {
      motion = at(k);
    } catch (const NumericalFailure&) {
      motion.reset();  // as a point that failed: nothing to show
    }
  }
}

MotionsOf on_a_belt(const Model& model, const dynamics::State& start, const scene::Scene& scene,
                    const MotionsRequest& request, const MotionTimes& times, const StopFlag* stop) {
  diagnostics::SweepOptions options;
  options.mode = SweepMode::kFollow;
  options.settle = scene::sweep_settle_options(scene);
  options.settle.energy_samples = 0;
  options.parallel = {.threads = 1, .stop = stop, .progress = {}};
  const diagnostics::SweepResult swept = diagnostics::sweep(model, request.values, start, options);
  if (swept.interrupted) throw Interrupted();
  MotionsOf out{.modes = model.basis ? model.basis->modes() : 0, .points = {}, .motions = {}};
  for (const diagnostics::SweepPoint& point : swept.points) {
    out.points.push_back(
        {.value = point.parameter,
         .said = point.ok() ? results::motion_text(point.settled.period) : "failed: " + point.failure});
    for (const diagnostics::SlipState& slip : point.settled.slips)
      if (slip.contact == 0) out.points.back().states.push_back(slip.displacement);
  }
  const pod::Basis* basis = model.basis ? &*model.basis : nullptr;
  record(
      request, stop,
      [&](std::size_t k) -> std::optional<Motion> {
        if (!swept.points[k].ok()) return std::nullopt;
        const dynamics::HybridSystem system = model.system(request.values[k]);
        const dynamics::State from = dynamics::handed_on(system, swept.points[k].settled.end);
        return recorded(system, basis, from, time_to_slip(system, from, times), request, times);
      },
      out);
  return out;
}

MotionsOf under_a_period(const diagnostics::DrivenModel& model, const pod::Basis* basis, const dynamics::State& start,
                         const scene::Scene& scene, const MotionsRequest& request, const std::vector<double>& natural,
                         const StopFlag* stop) {
  constexpr double kHarmonics = 25.0;  // shown of the drive's frequency: modes may lie far above all that is seen
  diagnostics::DrivenSweepOptions options;
  options.driven = scene::driven_options(scene);
  options.driven.exponent_cycles = 0.0;
  options.driven.flow.audit = false;
  options.parallel = {.threads = 1, .stop = stop, .progress = {}};
  const diagnostics::DrivenSweep swept = diagnostics::driven_sweep(model, request.values, start, options);
  if (swept.interrupted) throw Interrupted();
  MotionsOf out{.modes = basis != nullptr ? basis->modes() : 0, .points = {}, .motions = {}};
  for (const diagnostics::DrivenPoint& point : swept.points) {
    out.points.push_back({.value = point.parameter,
                          .said = point.ok() ? results::motion_text(point.settled) : "failed: " + point.failure});
    if (!point.ok()) continue;
    for (const double reading : point.settled.readings.row(0)) out.points.back().states.push_back(reading);
  }
  record(
      request, stop,
      [&](std::size_t k) -> std::optional<Motion> {
        if (!swept.points[k].ok()) return std::nullopt;
        const double hz = swept.points[k].settled.frequency_hz;
        const double seen = kHarmonics * hz;
        const MotionTimes times(1.0 / hz, natural.empty() ? seen : std::min(kAboveModes * natural.back(), seen),
                                request);
        return recorded(model(request.values[k]).system, basis, swept.points[k].settled.end, 0.0, request, times);
      },
      out);
  return out;
}

}  // namespace

std::vector<MotionsOf> motions(const scene::Scene& scene, const pod::NamedBasis& basis, const MotionsRequest& request,
                               const RunOptions& run) {
  if (request.values.empty()) throw InvalidInput("motions: expected at least one value of the drive, found none");
  const bool driven = is_driven(scene);
  const diagnostics::DrivenCase full =
      driven ? scene::driven_case(scene) : diagnostics::DrivenCase{.system = scene::build_system(scene)};
  const std::vector<double> natural = natural_hz(full.system);
  if (!driven && natural.empty())
    throw InvalidInput("motions: expected a structure that vibrates on its belt, found none that does");
  const dynamics::State start = scene::initial_state(scene, full.system);
  std::vector<MotionsOf> out(request.modes.size() + 1);
  rethrow_first(parallel_for(out.size(), run.parallel("motions"), [&](std::size_t m) {
    std::optional<pod::Basis> own;
    if (m > 0) own = basis.basis.truncated(request.modes[m - 1]);
    const dynamics::State from = own ? rom::restrict_state(full.system.structure(), *own, start) : start;
    if (driven) {
      out[m] = under_a_period(
          diagnostics::driven_model(own ? diagnostics::reduced_case(full, *own) : full, drive_over_own_key(scene)),
          own ? &*own : nullptr, from, scene, request, natural, run.stop);
      return;
    }
    const Model model = own ? diagnostics::reduced_belt_model(full.system, *own) : diagnostics::belt_model(full.system);
    out[m] = on_a_belt(model, from, scene, request,
                       MotionTimes(1.0 / natural.front(), kAboveModes * natural.back(), request), run.stop);
  }));
  return out;
}

}  // namespace slipmode::studies
