#include <slipmode/figures/motion_figures.hpp>

#include <slipmode/diagnostics/model.hpp>
#include <slipmode/diagnostics/series/spectrum.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/scene/driven.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::figures {
namespace {

using results::StoreReader;

/// The reading of a stored trajectory, with the time between samples.
struct ReadingSeries {
  Eigen::VectorXd values;
  double interval = 0.0, period = 0.0;
  std::string label;
};

ReadingSeries reading_of(const StoreReader& store) {
  const scene::Scene scene = results::load_scene_of(store);
  const dynamics::Trajectory run = results::load_trajectory(store);
  if (run.times.size() < 2) store.fail("trajectory/times", "too few samples to draw; simulate for longer");
  return {.values = driven_case(scene).readings.of(run.q).row(0),
          .interval = run.times[1] - run.times[0],
          .period = scene.drive.shaker()->period(),
          .label = axis_label(reading_name(scene), reading_unit(scene))};
}

/// Slider less contact, its rate, and the friction force of the first contact.
struct Loops {
  Eigen::VectorXd way, speed, force;
};

/// The cycles after a state, fine enough to draw, corners at events included: samples kept for statistics are too
/// coarse for the passages between stick and slip.
Loops loops_after(const scene::Scene& scene, const dynamics::State& state) {
  constexpr double kCycles = 8.0, kSamplesPerCycle = 1024.0;
  const dynamics::HybridSystem system = scene::build_system(scene);
  const friction::Shaker& shaker = *scene.drive.shaker();
  dynamics::FlowOptions flow = scene.flow;
  flow.audit = false;
  const dynamics::Trajectory run = dynamics::simulate(system, dynamics::handed_on(system, state, state.time),
                                                      {.duration = kCycles * shaker.period(),
                                                       .sample = shaker.period() / kSamplesPerCycle,
                                                       .output = dynamics::SimulateOptions::Output::kContacts,
                                                       .flow = flow});
  std::vector<double> way, speed, force;
  const auto add = [&](double t, double q, double v, double lambda) {
    way.push_back(shaker.displacement(t) - q);
    speed.push_back(shaker.velocity(t) - v);
    force.push_back(lambda);
  };
  auto event = run.events.begin();
  for (Eigen::Index i = 0; i < run.times.size(); ++i) {
    for (; event != run.events.end() && event->time <= run.times[i]; ++event) {
      if (event->contact == 0) add(event->time, event->displacement, event->velocity, event->force);
    }
    add(run.times[i], run.contact_q(0, i), run.contact_v(0, i), run.lambda(0, i));
  }
  return {to_vector(way), to_vector(speed), to_vector(force)};
}

}  // namespace

Figure friction_loops(const StoreReader& store) {
  const scene::Scene scene = results::load_scene_of(store);
  const results::Units units = results::Units::of(scene.units);
  const auto [way, speed, force] = loops_after(scene, results::load_trajectory(store).final_state);
  const std::string name = scene.contacts.front().name;
  return panel_grid(
      {{name, {{"", way, force, Series::Look::kLine, kFullColour}}, axis_label("slider less contact", units.length)},
       {name,
        {{"", speed, force, Series::Look::kDots, kFullColour}},
        axis_label("slider less contact, velocity", units.velocity)}},
      {.columns = 2,
       .panel_height = 460,
       .y_label = axis_label("friction force {/Symbol l}", units.force),
       .shared_x = false});
}

Figure reading_delay_map(const StoreReader& store) {
  const ReadingSeries series = reading_of(store);
  const auto delay =
      std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::lround(0.25 * series.period / series.interval)));
  const Eigen::Index count = series.values.size() - delay;
  if (count < 1) store.fail("trajectory/times", "too few samples for a delay map; simulate for longer");
  return panel_grid(
      {{fmt::format("delay of {:.3g}{}, a quarter of a drive period", static_cast<double>(delay) * series.interval,
                    results::load_scene_of(store).units == "SI" ? " s" : ""),
        {{"", series.values.head(count), series.values.tail(count), Series::Look::kDots, kFullColour}}}},
      {.columns = 1, .panel_height = 700, .x_label = series.label, .y_label = "the same, later"});
}

Figure reading_spectrum(const StoreReader& store) {
  constexpr double kShown = 25.0;  // in drive frequencies
  const ReadingSeries series = reading_of(store);
  const diagnostics::AmplitudeSpectrum found = diagnostics::amplitude_spectrum(series.values, series.interval);
  const double highest = kShown / series.period;
  Eigen::Index shown = 1;
  while (shown + 1 < found.frequency_hz.size() && found.frequency_hz[shown] < highest) ++shown;
  return panel_grid(
      {{fmt::format("mean of {} segments, Hann's window", found.segments),
        {{"", found.frequency_hz.segment(1, shown), found.amplitude.segment(1, shown), Series::Look::kLine,
          kFullColour}}}},
      {.columns = 1,
       .panel_height = 480,
       .x_label = axis_label("frequency", results::Units::of(results::load_scene_of(store).units).frequency),
       .y_label = "amplitude of the " + series.label,
       .log_y = true});
}

}  // namespace slipmode::figures
