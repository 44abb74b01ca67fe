#include "bench/basin_cases.hpp"

#include <slipmode/fem/masses.hpp>
#include <slipmode/orbits/basins.hpp>
#include "bench/basin_peer.hpp"
#include "bench/clock.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <numbers>

namespace slipmode::bench {
namespace {

/// A peer's motion has settled when it repeats to this.
constexpr double kRepeat = 1e-8;

dynamics::HybridSystem play_of(const PlayMass& mass) {
  const friction::Stop stop{.stiffness = 1.0, .gap = 1.0};
  return {fem::masses({.links = {{.damping = 2.0 * mass.xi}}}),
          {{Eigen::VectorXd::Ones(1), friction::Clearance{stop, stop, friction::ContactLoss::kGap}}},
          friction::Force{mass.omega, {{.amplitude = mass.amplitude, .phase = std::numbers::pi / 2.0}}},
          {},
          Eigen::MatrixXd::Ones(1, 1)};
}

dynamics::State state_at(double x, double v) {
  return {.q = Eigen::VectorXd::Constant(1, x), .v = Eigen::VectorXd::Constant(1, v)};
}

}  // namespace

Row measure_basins(bool quick) {
  Row row;
  row.lines.push_back(fmt::format("{:>10} {:>8} {:>10} {:>10} {:>12} {:>12} {:>8} {:>8} {:>8}", "basins", "dopri5",
                                  "until", "periods", "slipmode us", "dopri5 us", "ratio", "wanted", "others"));
  const int count = quick ? 21 : 101;
  orbits::MapGrid grid;
  for (int k = 0; k < count; ++k) grid.x.push_back(-2.0 + 4.0 * k / (count - 1));
  grid.y = grid.x;
  const std::pair<const char*, PlayMass> planes[] = {
      {"Figure 3", {0.13058, 0.1, 0.3}}, {"Figure 4", {0.19884, 0.1, 0.3}}, {"Figure 10", {0.2, 0.3, 0.5005}}};
  for (const auto& [name, mass] : planes) {
    const orbits::BasinFinder finder(play_of(mass), {});
    orbits::Basins own;
    const double ours = thread_seconds_of([&] { own = orbits::basins(finder, state_at, grid, {.threads = 1}); });
    const double starts = static_cast<double>(count) * count;
    for (const double tolerance : {1e-8, 1e-10, 1e-12}) {
      for (const bool same_periods : {true, false}) {
        std::vector<PlayEnd> ends;
        const double theirs = thread_seconds_of([&] {
          for (std::size_t j = 0; j < grid.y.size(); ++j) {
            for (std::size_t i = 0; i < grid.x.size(); ++i) {
              const Eigen::Vector2d start(grid.x[i], grid.y[j]);
              const int known = own.rows[j][i].periods;
              ends.push_back(same_periods ? PlayEnd{run_play_with_odeint(mass, start, known, tolerance), known}
                                          : settle_play_with_odeint(mass, start, kRepeat, tolerance));
            }
          }
        });
        int others = 0;  // starts that the peer's errors lead elsewhere
        double run = 0.0;
        for (std::size_t k = 0; k < ends.size(); ++k) {
          const orbits::BasinCell& cell = own.rows[k / grid.x.size()][k % grid.x.size()];
          const Eigen::Vector2d& end = ends[k].state;
          others += finder.follow(state_at(end(0), end(1)), own.attractors).cell.attractor != cell.attractor;
          run += ends[k].periods;
        }
        const char* until = same_periods ? "as ours" : "1e-8";
        row.lines.push_back(fmt::format("{:>10} {:>8.0e} {:>10} {:>10.2f} {:>12.2f} {:>12.1f} {:>8.1f} {:>8} {:>8}",
                                        name, tolerance, until, run / starts, 1e6 * ours / starts,
                                        1e6 * theirs / starts, theirs / ours, 30, others));
        const std::string key =
            fmt::format("basins_xi_{}_dopri5_{:.0e}_{}", mass.xi, tolerance, same_periods ? "same" : "settled");
        row.figures.emplace_back(key + "_slipmode_us", 1e6 * ours / starts);
        row.figures.emplace_back(key + "_dopri5_us", 1e6 * theirs / starts);
        row.figures.emplace_back(key + "_ratio", theirs / ours);
        row.timed.push_back({.name = fmt::format("basins {} dopri5 {:.0e} {}", name, tolerance, until),
                             .ms = 1e3 * ours,
                             .ratio_dopri5 = theirs / ours});
      }
    }
  }
  return row;
}

}  // namespace slipmode::bench
