#include "cli/motion_figures.hpp"

#include "cli/figures/panels.hpp"
#include "cli/figures/style.hpp"
#include "cli/shaken_model.hpp"
#include "cli/units.hpp"
#include "diagnostics/spectrum.hpp"
#include "scene/provenance.hpp"
#include "scene/records.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::cli {
namespace {

using figures::Figure;
using figures::Panel;
using figures::Series;
using scene::StoreReader;

/// The reading of a stored trajectory, with the time between samples.
struct ReadingSeries {
  Eigen::VectorXd values;
  double interval = 0.0, period = 0.0;
  std::string label;
};

ReadingSeries reading_of(const StoreReader& store) {
  const scene::Scene scene = scene::load_scene_of(store);
  const dynamics::Trajectory run = scene::load_trajectory(store);
  if (run.times.size() < 2) store.fail("trajectory/times", "too few samples to draw; simulate for longer");
  return {.values = shaken_case(scene).readings.of(run.q).row(0),
          .interval = run.times[1] - run.times[0],
          .period = scene.drive.shaker()->period(),
          .label = figures::axis_label(reading_name(scene), reading_unit(scene))};
}

}  // namespace

Figure friction_loops(const StoreReader& store) {
  constexpr double kCycles = 8.0;
  const scene::Scene scene = scene::load_scene_of(store);
  const Units units = Units::of(scene.units);
  const friction::Shaker& shaker = *scene.drive.shaker();
  const dynamics::Trajectory run = scene::load_trajectory(store);
  const double from = run.times[run.times.size() - 1] - kCycles * shaker.period();
  Eigen::Index first = 0;
  while (first + 1 < run.times.size() && run.times[first] < from) ++first;
  const Eigen::Index count = run.times.size() - first;
  Eigen::VectorXd way(count), speed(count), force(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double t = run.times[first + i];
    way[i] = shaker.displacement(t) - run.contact_q(0, first + i);
    speed[i] = shaker.velocity(t) - run.contact_v(0, first + i);
    force[i] = run.lambda(0, first + i);
  }
  const std::string name = scene.contacts.front().name;
  return figures::panel_grid({{name,
                               {{"", way, force, Series::Look::kLine, figures::kFullColour}},
                               figures::axis_label("slider less contact", units.length)},
                              {name,
                               {{"", speed, force, Series::Look::kDots, figures::kFullColour}},
                               figures::axis_label("slider less contact, velocity", units.velocity)}},
                             {.columns = 2,
                              .panel_height = 460,
                              .y_label = figures::axis_label("friction force {/Symbol l}", units.force),
                              .shared_x = false});
}

Figure delay_map(const StoreReader& store) {
  const ReadingSeries series = reading_of(store);
  const auto delay =
      std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::lround(0.25 * series.period / series.interval)));
  const Eigen::Index count = series.values.size() - delay;
  if (count < 1) store.fail("trajectory/times", "too few samples for a delay map; simulate for longer");
  return figures::panel_grid(
      {{fmt::format("delay of {:.3g}{}, a quarter of a drive period", static_cast<double>(delay) * series.interval,
                    scene::load_scene_of(store).units == "SI" ? " s" : ""),
        {{"", series.values.head(count), series.values.tail(count), Series::Look::kDots, figures::kFullColour}}}},
      {.columns = 1, .panel_height = 700, .x_label = series.label, .y_label = "the same, later"});
}

Figure spectrum(const StoreReader& store) {
  constexpr double kShown = 25.0;  // in drive frequencies
  const ReadingSeries series = reading_of(store);
  const diagnostics::AmplitudeSpectrum found = diagnostics::amplitude_spectrum(series.values, series.interval);
  const double highest = kShown / series.period;
  Eigen::Index shown = 1;
  while (shown + 1 < found.frequency_hz.size() && found.frequency_hz[shown] < highest) ++shown;
  return figures::panel_grid(
      {{fmt::format("mean of {} segments, Hann's window", found.segments),
        {{"", found.frequency_hz.segment(1, shown), found.amplitude.segment(1, shown), Series::Look::kLine,
          figures::kFullColour}}}},
      {.columns = 1,
       .panel_height = 480,
       .x_label = figures::axis_label("frequency", Units::of(scene::load_scene_of(store).units).frequency),
       .y_label = "amplitude of the " + series.label,
       .log_y = true});
}

}  // namespace slipmode::cli
