#include <slipmode/trade/clock.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/timing.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <optional>

namespace slipmode::trade {

namespace {

/// One configuration on its way.
struct Runner {
  std::optional<Case> model;
  dynamics::State start;
  Times building, first;
  std::vector<Times> repeats;
  std::string failure;

  void run(double simulated, Times& out_times) {
    const dynamics::SimulateOptions options{.duration = simulated,
                                            .keep_events = false,
                                            .output = dynamics::SimulateOptions::Output::kContacts,
                                            .flow = model->flow};
    out_times = timed([&] { (void)dynamics::simulate(model->model.system, start, options); });
  }

  /// A failure is kept, and ends this one's runs.
  template <class Work>
  void guarded(const Work& work) {
    if (!failure.empty()) return;
    try {
      work();
    } catch (const NumericalFailure& failed) {
      failure = failed.what();
    } catch (const InvalidInput& refused) {
      failure = refused.what();
    }
  }

  [[nodiscard]] RunCost cost(double simulated) const {
    RunCost out{.simulated = simulated, .failure = failure};
    if (!failure.empty() || repeats.empty()) return out;
    const Times middle = median_times(repeats);
    const auto [low, high] = std::ranges::minmax_element(repeats, {}, &Times::cpu);
    out.wall = middle.wall;
    out.cpu = middle.cpu;
    out.cpu_low = low->cpu;
    out.cpu_high = high->cpu;
    out.setup = building.cpu + std::max(0.0, first.cpu - middle.cpu);
    return out;
  }
};

}  // namespace

std::vector<RunCost> measure_costs(const std::vector<Timed>& all, double simulated, int repeats,
                                   const ParallelOptions& options) {
  if (!(simulated > 0.0) || repeats < 1) {
    throw InvalidInput(fmt::format("costs: expected a time > 0 and repeats >= 1, found {} and {}", simulated, repeats));
  }
  std::vector<Runner> runners(all.size());
  const std::size_t total = all.size() * static_cast<std::size_t>(repeats + 1);
  std::size_t done = 0;
  const auto advance = [&] {
    if (options.stop != nullptr && options.stop->load()) throw Interrupted();
    if (options.progress) options.progress(++done, total);
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    Runner& runner = runners[i];
    runner.guarded([&] {
      runner.building = timed([&] { runner.model = all[i].build(); });
      runner.start = all[i].start(*runner.model);
      runner.run(simulated, runner.first);
    });
    advance();
  }
  for (int k = 0; k < repeats; ++k) {
    for (Runner& runner : runners) {
      runner.guarded([&] {
        Times times;
        runner.run(simulated, times);
        runner.repeats.push_back(times);
      });
      advance();
    }
  }
  std::vector<RunCost> costs;
  for (const Runner& runner : runners) costs.push_back(runner.cost(simulated));
  return costs;
}

}  // namespace slipmode::trade
