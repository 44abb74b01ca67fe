#include <slipmode/studies/motions.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/shaken.hpp>
#include <slipmode/scene/solver_options.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::studies {
namespace {

using diagnostics::Model;
using dynamics::Event;

/// Times that all models share: those of the full structure.
struct MotionTimes {
  double interval = 0.0, lead = 0.0, kept = 0.0, spectrum = 0.0, highest_hz = 0.0;

  MotionTimes(const dynamics::HybridSystem& full, const MotionsRequest& request) {
    constexpr Eigen::Index kResolved = 20;
    const Eigen::VectorXd omega = fem::natural_modes(full.structure(), std::min(kResolved, full.size())).omega;
    const auto vibrates = std::ranges::find_if(omega, [](double one) { return one > 0.0; });
    if (vibrates == omega.end())
      throw InvalidInput("motions: expected a structure that vibrates, found none that does");
    const double slowest = 2.0 * std::numbers::pi / *vibrates;
    kept = request.periods * slowest;
    interval = kept / static_cast<double>(request.samples - 1);
    lead = 2.0 * slowest;
    spectrum = request.spectrum_periods * slowest;
    highest_hz = 1.3 * omega[omega.size() - 1] / (2.0 * std::numbers::pi);
  }
};

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

Motion recorded(const dynamics::HybridSystem& system, const Model& model, const dynamics::State& start,
                const MotionsRequest& request, const MotionTimes& times) {
  const dynamics::State from = dynamics::handed_on(system, start);
  const double lead = time_to_slip(system, from, times);
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
  motion.shape = model.basis ? Eigen::MatrixXd((request.readings * model.basis->vectors * q).colwise() +
                                               request.readings * model.basis->mean)
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

MotionsOf motions_of(const Model& model, const dynamics::State& start, const scene::Scene& scene,
                     const MotionsRequest& request, const MotionTimes& times, const StopFlag* stop) {
  diagnostics::SweepOptions options;
  options.mode = SweepMode::kFollow;
  options.settle = scene::sweep_settle_options(scene);
  options.settle.energy_samples = 0;
  options.parallel = {.threads = 1, .stop = stop, .progress = {}};
  diagnostics::SweepResult swept = diagnostics::sweep(model, request.speeds, start, options);
  if (swept.interrupted) throw Interrupted();
  MotionsOf out{.modes = model.basis ? model.basis->modes() : 0, .points = std::move(swept.points), .motions = {}};
  for (std::size_t k = 0; k < request.speeds.size(); ++k) {
    if (!request.recorded[k]) continue;
    if (stop != nullptr && stop->load()) throw Interrupted();
    std::optional<Motion>& motion = out.motions.emplace_back();
    if (!out.points[k].ok()) continue;
    try {
      motion = recorded(model.system(request.speeds[k]), model, out.points[k].settled.end, request, times);
    } catch (const NumericalFailure&) {
      motion.reset();  // as a point that failed: nothing to show
    }
  }
  return out;
}

}  // namespace

std::vector<MotionsOf> motions(const scene::Scene& scene, const pod::NamedBasis& basis, const MotionsRequest& request,
                               const RunOptions& run) {
  if (scene.force || is_shaken(scene)) throw InvalidInput("motions: expected a belt, found another drive");
  if (request.speeds.empty()) throw InvalidInput("motions: expected at least one speed, found none");
  const dynamics::HybridSystem full = scene::build_system(scene);
  const MotionTimes times(full, request);
  const dynamics::State start = scene::initial_state(scene, full);
  std::vector<MotionsOf> out(request.modes.size() + 1);
  rethrow_first(parallel_for(out.size(), run.parallel("motions"), [&](std::size_t m) {
    const Model model = m == 0 ? diagnostics::belt_model(full)
                               : diagnostics::reduced_belt_model(full, basis.basis.truncated(request.modes[m - 1]));
    const dynamics::State own = m == 0 ? start : rom::restrict_state(full.structure(), *model.basis, start);
    out[m] = motions_of(model, own, scene, request, times, run.stop);
  }));
  return out;
}

}  // namespace slipmode::studies
