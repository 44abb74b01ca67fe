#include <slipmode/trade/study.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/core/sweep_runner.hpp>
#include <slipmode/diagnostics/attractors/driven.hpp>
#include <slipmode/trade/variants.hpp>
#include "trade/internal/horizon.hpp"
#include "trade/internal/motion.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <variant>

namespace slipmode::trade {

namespace {

/// Of starts about the scene's own where [ensemble] has none: enough for a chaotic motion to forget.
constexpr double kSpread = 1e-4;

/// The scene's start, then `others` about it from another seed than the ensemble's.
std::vector<dynamics::State> starts_of(const scene::Scene& scene, const dynamics::HybridSystem& system, int others) {
  std::vector<dynamics::State> starts = {scene::initial_state(scene, system)};
  scene::Scene about = scene;
  about.ensemble.members = others;
  about.ensemble.seed = scene.ensemble.seed + 1;
  if (about.ensemble.spread == 0.0) about.ensemble.spread = kSpread;
  std::ranges::move(scene::ensemble_states(about, system), std::back_inserter(starts));
  return starts;
}

/// A start whose time is a section of a shaker; elsewhere time 0.
dynamics::State at_phase(const dynamics::HybridSystem& system, const dynamics::State& state) {
  const friction::Shaker* shaker = system.drive().shaker();
  return dynamics::handed_on(system, state, shaker != nullptr ? shaker->next_upward_zero(0.0) : 0.0);
}

class Work {
 public:
  Work(const scene::Scene& scene, const Variant& reference, const std::vector<OfferedBasis>& bases,
       const StudyOptions& options)
      : scene_(scene), bases_(bases), options_(options), schedule_(options.schedule) {
    out_.reference.variant = reference;
    out_.schedule = schedule_;
    model_ = build_case(reference, bases);
  }

  Study run(const std::vector<Variant>& variants) {
    run_reference();
    if (!measure(variants, options_.leave)) return std::move(out_);
    if (options_.more) measure(options_.more(out_.rows));
    if (options_.sharing.leads) take_times();
    return std::move(out_);
  }

 private:
  [[nodiscard]] const StopFlag* stop() const { return options_.parallel.stop; }

  void run_reference() {
    const Case own = build_case(as_it_stands(scene_), bases_);
    const std::vector<dynamics::State> starts = starts_of(scene_, own.full, schedule_.runs - 1);
    motions_.resize(starts.size());
    std::vector<std::vector<dynamics::State>> along(starts.size());
    rethrow_first(parallel_for(starts.size(), options_.parallel, [&](std::size_t i) {
      const dynamics::State start = at_phase(model_->model.system, handed_on(own, *model_, starts[i]));
      motions_[i] = run_motion(*model_, start, schedule_.first_transient, schedule_, stop());
      along[i] = states_of(*model_, motions_[i].end, schedule_.starts, schedule_.gap, stop());
    }));
    for (const auto& states : along) shared_.insert(shared_.end(), states.begin(), states.end());
    out_.reference.error.fill(0.0);
    out_.reference.noise = scatter_ = motion_scatter(motions_);
  }

  /// False when some were left to others.
  bool measure(const std::vector<Variant>& variants, const decltype(StudyOptions::leave)& leave = {}) {
    if (variants.empty()) return true;
    const std::size_t first = out_.rows.size();
    for (const Variant& variant : variants) {
      out_.rows.push_back({.variant = variant, .basis_seconds = basis_seconds(variant)});
    }
    std::vector<double> numbers(variants.size());
    std::iota(numbers.begin(), numbers.end(), 0.0);
    const auto settle = [&](std::size_t i, int, const std::monostate&) { return errors_of(variants[i]); };
    auto found = SweepRunner<Finished, std::monostate>(
                     {.settle = settle, .carry = [](const Finished&) { return std::monostate(); }}, numbers, {},
                     SweepMode::kIndependent, 1, options_.parallel, sink_of(variants, leave))
                     .run_alone();
    if (found.interrupted) throw Interrupted();
    for (const auto& point : found.points) {
      Row& row = out_.rows[first + point.index];
      row.error = point.settled.error;
      row.noise = point.settled.noise;
      row.failure = point.settled.failure;
    }
    return found.points.size() == variants.size();
  }

  /// What is kept of configurations, by their names.
  [[nodiscard]] SinkOf<Finished> sink_of(const std::vector<Variant>& variants,
                                         const decltype(StudyOptions::leave)& leave) const {
    SinkOf<Finished> sink{.sharing = options_.sharing, .for_all = true};
    if (options_.recall) {
      sink.recall = [&](std::size_t i, int) -> std::optional<SweptValue<Finished>> {
        auto known = options_.recall(variants[i].name);
        if (!known) return std::nullopt;
        return SweptValue<Finished>{.index = i, .parameter = static_cast<double>(i), .settled = std::move(*known)};
      };
    }
    if (options_.store) {
      sink.store = [&](const SweptValue<Finished>& value) {
        options_.store(variants[value.index].name, value.settled);
      };
    }
    if (leave)
      sink.leave = [&](std::size_t piece, std::size_t i, int, double) { return leave(piece, variants[i].name); };
    return sink;
  }

  [[nodiscard]] double basis_seconds(const Variant& variant) const {
    if (!variant.reduction) return 0.0;
    const auto found = std::ranges::find(bases_, variant.reduction->basis, &OfferedBasis::choice);
    return found == bases_.end() ? 0.0 : found->seconds;
  }

  [[nodiscard]] Finished errors_of(const Variant& variant) const {
    Finished out;
    out.error.fill(kNone);
    out.noise = scatter_;
    at(out.noise, Measure::kDx) = at(out.noise, Measure::kDe) = kNone;
    try {
      const Case candidate = build_case(variant, bases_);
      const Motion motion = run_motion(candidate, handed_on(*model_, candidate, motions_.front().end),
                                       schedule_.transient, schedule_, stop());
      out.error = motion_distance(motions_.front(), motion);
      const HorizonDeviation horizon = horizon_deviation(*model_, candidate, shared_, schedule_, stop());
      at(out.error, Measure::kDx) = horizon.dX;
      at(out.error, Measure::kDe) = horizon.dE;
      at(out.noise, Measure::kDx) = horizon.dX_scatter;
      at(out.noise, Measure::kDe) = horizon.dE_scatter;
    } catch (const NumericalFailure& failure) {
      out.failure = failure.what();
    } catch (const InvalidInput& refusal) {
      out.failure = refusal.what();
    }
    return out;
  }

  [[nodiscard]] Timed timed(const Variant& variant) const {
    return {.build = [&] { return build_case(variant, bases_); },
            .start = [this](const Case& candidate) { return handed_on(*model_, candidate, motions_.front().end); }};
  }

  void take_times() {
    std::vector<Timed> all = {timed(out_.reference.variant)};
    for (const Row& row : out_.rows) all.push_back(timed(row.variant));
    const std::vector<RunCost> costs = measure_costs(all, schedule_.timed, schedule_.repeats, options_.parallel);
    out_.reference.cost = costs.front();
    for (std::size_t i = 0; i < out_.rows.size(); ++i) {
      out_.rows[i].cost = costs[i + 1];
      if (out_.rows[i].failure.empty()) out_.rows[i].failure = costs[i + 1].failure;
    }
  }

  const scene::Scene& scene_;
  const std::vector<OfferedBasis>& bases_;
  const StudyOptions& options_;
  const Schedule& schedule_;
  std::optional<Case> model_;  ///< the reference's
  std::vector<Motion> motions_;
  std::vector<dynamics::State> shared_;
  Values scatter_ = {};
  Study out_;
};

}  // namespace

std::vector<Offer> Study::offers(Measure measure) const {
  std::vector<Offer> all;
  for (const Row& row : rows) all.push_back(row.offer(measure));
  return all;
}

Study study(const scene::Scene& scene, const Variant& reference, const std::vector<Variant>& variants,
            const std::vector<OfferedBasis>& bases, const StudyOptions& options) {
  return Work(scene, reference, bases, options).run(variants);
}

}  // namespace slipmode::trade
