#include <slipmode/trade/study.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/core/sweep_runner.hpp>
#include <slipmode/diagnostics/attractors/driven.hpp>
#include <slipmode/trade/parting.hpp>
#include <slipmode/trade/variants.hpp>
#include "trade/internal/horizon.hpp"
#include "trade/internal/motion.hpp"

#include <algorithm>
#include <cmath>
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

/// A start whose time is a section of the drive.
dynamics::State at_phase(const dynamics::HybridSystem& system, const dynamics::State& state) {
  return dynamics::handed_on(system, state, system.drive().section_time());
}

/// So many that two standard errors of a difference, and their own scatter, fit into `change`.
std::size_t runs_to_resolve(const Values& scatter, double change) {
  constexpr double kFits = 2.5;
  double runs = 2.0;
  for (const double one : scatter) {
    if (!std::isnan(one)) runs = std::max(runs, std::ceil(std::pow(kFits * one / change, 2)));
  }
  return static_cast<std::size_t>(std::min<double>(runs, kMostRuns));
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
    out_.shared_starts = ground_.shared.size();
    if (!measure(variants, options_.leave)) return std::move(out_);
    while (options_.more && measure_new(options_.more(out_.rows))) continue;
    if (options_.sharing.leads) take_times();
    return std::move(out_);
  }

 private:
  [[nodiscard]] const StopFlag* stop() const { return options_.parallel.stop; }

  /// What configurations are run from, in the reference's coordinates, and compared with.
  struct Ground {
    std::vector<Motion> motions;          ///< of the reference; none of one that dies out
    std::vector<dynamics::State> begins;  ///< of each motion's counterpart
    double transient = 0.0;               ///< run from there before it is recorded
    std::vector<dynamics::State> shared;  ///< starts up to the horizon
  };

  void run_reference() {
    const Case own = build_case(as_it_stands(scene_), bases_);
    const auto first = static_cast<std::size_t>(schedule_.runs);
    const int most = options_.resolve ? std::max(kMostRuns, 2 * schedule_.runs) : schedule_.runs;
    for (const dynamics::State& start : starts_of(scene_, own.full, most - 1)) {
      starts_.push_back(at_phase(model_->model.system, handed_on(own, *model_, start)));
    }
    ground_.transient = schedule_.transient;
    out_.reference.error.fill(0.0);
    out_.reference.noise.fill(kNone);
    out_.dies_out = options_.dies_out;
    if (!out_.dies_out) {
      run_motions(first);
      out_.dies_out = !options_.resolve && has_died_out();
    }
    if (out_.dies_out) {
      ground_.motions.clear();
      ground_.shared.assign(starts_.begin(), starts_.begin() + schedule_.runs);
      return;
    }
    tell_kinds();
    share_starts(ground_);
    if (options_.resolve) run_motions(runs_to_resolve(out_.reference.noise, *options_.resolve));
    for (const Motion& motion : ground_.motions) ground_.begins.push_back(motion.end);
  }

  /// The reference's motions from its first `count` starts, those that there are kept.
  void run_motions(std::size_t count) {
    std::vector<Motion>& motions = ground_.motions;
    const std::size_t known = std::min(motions.size(), count);
    motions.resize(count);
    rethrow_first(parallel_for(count - known, options_.parallel, [&](std::size_t k) {
      const std::size_t i = known + k;
      motions[i] = run_motion(*model_, starts_[i], schedule_.first_transient, schedule_, stop());
    }));
  }

  /// Whether nothing is left of the motion from the scene's start.
  [[nodiscard]] bool has_died_out() const {
    constexpr double kGone = 1e-6;
    if (scene_.drive.belt() == nullptr) return false;
    const Parting later = parting(*model_, ground_.motions.front().end, 1, schedule_, stop());
    const Parting from_start = parting(*model_, starts_.front(), 1, schedule_, stop());
    require_motion(from_start, later);
    return later.reach <= kGone * from_start.reach;
  }

  /// The scatter is that of the motion which the scene's own start ends on. Of runs that end elsewhere, told by ten
  /// times the distance of two stretches of that motion, a configuration that is measured run by run keeps its own.
  void tell_kinds() {
    constexpr double kElsewhere = 10.0, kSame = 1.0;  // stretches; percent
    std::vector<Motion>& motions = ground_.motions;
    const auto apart = [&motions](const Motion& other) {
      return at(motion_distance(motions.front(), other), Measure::kSpread);
    };
    std::vector<double> distances(motions.size());
    std::ranges::transform(motions, distances.begin(), apart);
    if (std::ranges::none_of(distances, [](double distance) { return distance > kSame; })) {
      out_.reference.noise = motion_scatter(motions);
      return;
    }
    const Motion next = run_motion(*model_, motions.front().end, 0.0, schedule_, stop());
    const double limit = std::max(kSame, kElsewhere * apart(next));
    std::vector<Motion> alike;
    for (std::size_t k = 0; k < motions.size(); ++k)
      if (!(distances[k] > limit)) alike.push_back(motions[k]);
    out_.elsewhere = motions.size() - alike.size();
    if (alike.size() < 2) alike.push_back(next);
    out_.reference.noise = motion_scatter(alike);
    if (!options_.resolve) motions = std::move(alike);
  }

  /// Shared starts along the first motions.
  void share_starts(Ground& ground) const {
    std::vector<std::vector<dynamics::State>> along(
        std::min(ground.motions.size(), static_cast<std::size_t>(schedule_.runs)));
    rethrow_first(parallel_for(along.size(), options_.parallel, [&](std::size_t i) {
      along[i] = states_of(*model_, ground.motions[i].end, schedule_.starts, schedule_.gap, stop());
    }));
    for (const auto& states : along) ground.shared.insert(ground.shared.end(), states.begin(), states.end());
  }

  /// What has decided nothing: the reference's motions go on, and a lean scene finds its own from the scene's starts.
  void run_on() {
    if (out_.dies_out) {
      const auto after = starts_.begin() + schedule_.runs;
      fresh_.shared.assign(after, after + schedule_.runs);
      return;
    }
    fresh_.motions.resize(ground_.motions.size());
    rethrow_first(parallel_for(fresh_.motions.size(), options_.parallel, [&](std::size_t i) {
      fresh_.motions[i] = run_motion(*model_, ground_.motions[i].end, 0.0, schedule_, stop());
    }));
    fresh_.begins = starts_;
    fresh_.transient = schedule_.first_transient;
    share_starts(fresh_);
  }

  /// Those of the variants that no row has yet; false when there are none.
  bool measure_new(std::vector<Variant> variants) {
    std::erase_if(variants, [&](const Variant& variant) {
      return std::ranges::any_of(out_.rows, [&](const Row& row) { return row.variant.name == variant.name; });
    });
    const bool lean = std::ranges::any_of(variants, [](const Variant& v) { return v.axis == Axis::kLean; });
    if (lean && fresh_.shared.empty()) run_on();
    measure(variants);
    return !variants.empty();
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
    out.noise = out_.reference.noise;
    at(out.noise, Measure::kDx) = at(out.noise, Measure::kDe) = kNone;
    try {
      const Case candidate = build_case(variant, bases_);
      const Ground& ground = variant.axis == Axis::kLean ? fresh_ : ground_;
      if (!ground.motions.empty()) compare_motions(candidate, ground, out);
      const HorizonDeviation horizon =
          horizon_deviation(*model_, candidate, ground.shared, schedule_,
                            options_.resolve ? HorizonStarts::kReference : HorizonStarts::kCandidate, stop());
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

  void compare_motions(const Case& candidate, const Ground& ground, Finished& out_finished) const {
    std::vector<Motion> motions;
    for (std::size_t k = 0; k < (options_.resolve ? ground.motions.size() : 1); ++k) {
      motions.push_back(
          run_motion(candidate, handed_on(*model_, candidate, ground.begins[k]), ground.transient, schedule_, stop()));
    }
    if (!options_.resolve) {
      out_finished.error = motion_distance(ground.motions.front(), motions.front());
      return;
    }
    const MotionChange change = motion_change(ground.motions, motions);
    out_finished.error = change.error;
    out_finished.noise = change.noise;
  }

  [[nodiscard]] Timed timed(const Variant& variant) const {
    return {.build = [&] { return build_case(variant, bases_); },
            .start = [this](const Case& candidate) { return handed_on(*model_, candidate, ground_.shared.front()); }};
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
  std::optional<Case> model_;            ///< the reference's
  std::vector<dynamics::State> starts_;  ///< of the reference
  Ground ground_, fresh_;                ///< fresh: for lean scenes
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
