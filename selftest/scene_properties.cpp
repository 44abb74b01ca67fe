#include "selftest/scene_properties.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/modal_model.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/pod/pomf.hpp>
#include <slipmode/pod/sensors.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/scene.hpp>
#include "selftest/random_scene.hpp"
#include "selftest/scene_rates.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

namespace slipmode::selftest {
namespace {

using Eigen::Index;

/// Random bases of more vectors round by more than what contacts tell apart.
constexpr Index kLargestAtRandom = 12;

/// Energy gap, of the energy exchanged.
constexpr double kEnergyLimit = 1e-9;
/// Two runs of the same motion, of its sizes: rounding and tolerance times what the motion multiplies them by.
constexpr double kSameMotion = 1e-5;
/// Of the fastest rate; samples where nothing has one, and the most there are.
constexpr double kPhasePerSample = 0.04, kFewest = 64.0, kMostSamples = 6000.0;
/// One scene in so many is run for as many radians of its slipping structure.
constexpr double kRunLonger = 4.0;

/// Other starts to rounding, of the motion's sizes.
constexpr int kRounded = 16;
constexpr double kRoundedBy = 1e-15;
/// Of a run's time, what the time of an event is off by in closed form, and by collocation in tolerances.
constexpr double kOfTime = 1e-14, kOfTolerance = 100.0;
/// Of a run's time, and of what they are from where it is cut, what events of other starts are apart.
constexpr double kSameTime = 1e-9, kApart = 1e-2;
/// Two events of a contact that graze are no further apart; a bristle at rest pulls with no more than this share.
constexpr double kGrazes = 1e-6, kAtRest = 1e-10;
/// What is on a stop, as far as is told, rests on it at this share of the motion's speeds.
constexpr double kRests = 1e-9;
/// Powers of ten of its duration that a run is cut beside an event.
constexpr double kNear = 5.0, kNearest = 12.0;

/// Speeds up to this are rounding: forces that all contacts hold leave nothing that moves, and nothing to measure by.
constexpr double kStill = 1e-9;

/// Of the flow: what two runs of one scene differ by must be rounding, not steps of different lengths.
constexpr double kTolerance = 1e-11;

/// FNV-1a over the bits of doubles.
class Digest {
 public:
  void add(std::uint64_t bits) {
    for (int shift = 0; shift < 64; shift += 8) value_ = (value_ ^ ((bits >> shift) & 0xffU)) * 0x100000001b3ULL;
  }
  void add(const Eigen::VectorXd& values) {
    for (const double v : values) add(std::bit_cast<std::uint64_t>(v));
  }
  void add(const dynamics::Trajectory& run) {
    add(run.final_state.q);
    add(run.final_state.v);
    add(run.final_state.internal);
    for (const dynamics::Event& e : run.events) add(std::bit_cast<std::uint64_t>(e.time));
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// What a flow lets speeds be off by, nothing in closed form [m/s].
double tolerated_speed(const dynamics::HybridSystem& system, const dynamics::SimulateOptions& options) {
  const Eigen::MatrixXd& mobility = system.cache().tables(system, false).model.mobility;
  return tolerated_impulses(system, options.flow, options.duration).cwiseProduct(mobility.diagonal()).maxCoeff();
}

class SceneChecker {
 public:
  SceneChecker(std::string text, std::uint64_t seed, std::uint64_t index)
      : random_(Random::stream(seed ^ 0x5eedULL, index)), text_(std::move(text)) {
    result_.index = index;
  }

  SceneCheck run() {
    guarded("scene", [&] { build(); });
    if (!system_) return result_;
    guarded("run", [&] { simulate(); });
    if (!simulated_) return result_;
    result_.still = size_v_ < kStill;
    if (result_.still) return result_;
    const bool told = !result_.scan.coasts;  // else rounding may say what follows: other runs are no comparison
    if (told) guarded("restart", [&] { take_up_again(); });
    if (told) guarded("reduction", [&] { reduce(); });
    guarded("longer run", [&] { run_longer(); });
    if (told) guarded("cut", [&] { cut(); });
    return result_;
  }

 private:
  template <class Part>
  void guarded(const char* what, const Part& part) {
    try {
      part();
    } catch (const NumericalFailure& failure) {
      // A clear failure, as documented: pairs that lose too many digits.
      if (std::string_view(failure.what()).find("workable") != std::string_view::npos)
        result_.refused = "nearly defective damping";
      else
        violate(what, failure.what());
    } catch (const InvalidInput& error) {
      violate(what, error.what());
    }
  }

  void violate(const char* property, const std::string& what) { result_.violations.push_back({property, what}); }

  void build() {
    const scene::Scene scene = scene::parse_scene(text_);
    const std::string written = scene::scene_to_toml(scene);
    const scene::Scene again = scene::parse_scene(written);
    if (scene::scene_to_toml(again) != written) violate("round trip", "the scene written twice is not the same text");
    if (scene.beam() != nullptr) beam_.emplace(scene::build_beam(scene));
    system_.emplace(scene::build_system(scene));
    const dynamics::HybridSystem copy = scene::build_system(again);
    const auto same = [](const fem::Matrix& a, const fem::Matrix& b) { return fem::to_dense(a) == fem::to_dense(b); };
    bool equal = same(system_->structure().M(), copy.structure().M()) &&
                 same(system_->structure().C(), copy.structure().C()) &&
                 same(system_->structure().K(), copy.structure().K());
    for (std::size_t c = 0; c < copy.contacts().size(); ++c)
      equal = equal && copy.contacts()[c].direction == system_->contacts()[c].direction;
    if (!equal) violate("round trip", "the scene written and read again is another system");
    start_ = scene::initial_state(scene, *system_);
    options_ = scene::simulate_options(scene);
    whole_ = options_.duration;
    options_.sample = std::min(kPhasePerSample / fastest_rate(*system_, start_), options_.duration / kFewest);
    options_.duration = std::min(options_.duration, kMostSamples * options_.sample);
    options_.transient = 0.0;
    options_.flow.tolerance = kTolerance;
    tolerated_ = tolerated_speed(*system_, options_);
  }

  void simulate() {
    options_.event_states = true;
    options_.on_event = [&](const dynamics::Event&, const dynamics::State& state) {
      events_.push_back(state);
      return true;
    };
    run_ = dynamics::simulate(*system_, start_, options_);
    options_.on_event = {};
    simulated_ = true;
    Digest digest;
    digest.add(run_);
    result_.digest = digest.value();
    size_q_ = run_.q.cwiseAbs().maxCoeff() + 1e-300;
    size_v_ = run_.v.cwiseAbs().maxCoeff() + 1e-300;
    if (size_v_ < kStill) return;
    check_balance(run_.audit);
    result_.scan = scan_run(*system_, start_, options_, run_, result_.violations);
  }

  void check_balance(const dynamics::EnergyAudit& audit) {
    const double residual = std::abs(audit.residual());
    result_.energy = std::max(result_.energy, residual);
    const double told = tolerated_ / size_v_;  // what a force is off by works at the speed there is
    if (!(residual <= std::max(kEnergyLimit, told))) violate("energy", fmt::format("residual {:.2g}", residual));
    if (audit.viscous_loss < -1e-12 * audit.exchanged)
      violate("energy", fmt::format("viscous loss {:.2g} is negative", audit.viscous_loss));
  }

  /// Samples follow the stiffest contact. Without any, for as many radians of the slipping structure: events and
  /// balance alone.
  void run_longer() {
    if (random_.uniform() * kRunLonger > 1.0) return;
    dynamics::SimulateOptions options = plain();
    options.flow.audit = true;
    const double rate = std::max(system_->cache().tables(*system_, false).model.fastest, kSlowest);
    options.duration = std::min(whole_, kMostSamples * kPhasePerSample / rate);
    if (options.duration > options_.duration) check_balance(dynamics::simulate(*system_, start_, options).audit);
  }

  /// In two pieces, the first of which ends anywhere, a little before or a little after an event: the same motion and
  /// the same events.
  void cut() {
    cut_at(start_.time + random_.uniform() * options_.duration);
    if (events_.empty()) return;
    for (const double side : {-1.0, 1.0}) {
      const auto pick = static_cast<std::size_t>(random_.uniform() * static_cast<double>(events_.size()));
      const double beside = std::pow(10.0, -random_.uniform(kNear, kNearest)) * options_.duration;
      cut_at(events_[pick].time + side * beside);
    }
  }

  void cut_at(double end) {
    const double last = start_.time + options_.duration;
    if (!(end > start_.time && end < last)) return;
    dynamics::SimulateOptions options = plain();
    options.duration = end - start_.time;
    const dynamics::Trajectory first = dynamics::simulate(*system_, start_, options);
    options.duration = last - end;
    dynamics::Trajectory second = dynamics::simulate(*system_, first.final_state, options);
    const double gap = distance(second.final_state, run_.final_state);
    result_.cut = std::max(result_.cut, gap);
    if (!(gap <= kSameMotion)) violate("cut", fmt::format("{:.2g} away at the end, cut at t = {:.17g}", gap, end));
    // It has an event beside its end or not, but for what events' times are off by; and what the run starts with may be
    // told when it goes on.
    const double off = (tolerated_ > 0.0 ? kOfTolerance * kTolerance : kOfTime) * options_.duration;
    std::vector<dynamics::Event> events = first.events;
    for (dynamics::Event& e : second.events) {
      e.time = std::max(e.time, std::nextafter(end, last));  // what it starts with is not the first's
      events.push_back(e);
    }
    const std::vector<dynamics::Event> whole = told_for_sure(run_.events), pieces = told_for_sure(events);
    const auto told_by = [](const std::vector<dynamics::Event>& told, double time) {
      return std::count_if(told.begin(), told.end(), [&](const auto& e) { return e.time <= time; });
    };
    const std::ptrdiff_t before = told_by(pieces, end);
    const bool same = pieces.size() == whole.size() && before <= told_by(whole, end + off) &&
                      before >= told_by(whole, end - off) - told_by(whole, start_.time);
    if (!same && !rests_on_a_stop(first.final_state) && events_are_told(end))
      violate("cut", fmt::format("{} and {} events instead of {}, cut at t = {:.17g}", first.events.size(),
                                 second.events.size(), run_.events.size(), end));
  }

  /// Whether a contact is at rest on one of its stops to what can be told: then rounding says whether it is left.
  [[nodiscard]] bool rests_on_a_stop(const dynamics::State& state) const {
    return std::ranges::any_of(system_->contacts(), [&](const friction::Contact& contact) {
      const friction::Clearance* stops = friction::clearance(contact.law);
      if (stops == nullptr) return false;
      const double y = contact.direction.dot(state.q) + contact.offset;
      const auto at = [&](const std::optional<friction::Stop>& stop, double side) {
        return stop && std::abs(side * y - stop->gap) <= kTold * size_q_;
      };
      return (at(stops->left, -1.0) || at(stops->right, 1.0)) &&
             std::abs(contact.direction.dot(state.v)) <= kRests * size_q_ * kPhasePerSample / options_.sample;
    });
  }

  /// Events but those that rounding may tell: of contacts that leave their mode for so short a time, or not at all, and
  /// turns of bristles at rest.
  [[nodiscard]] std::vector<dynamics::Event> told_for_sure(const std::vector<dynamics::Event>& events) const {
    std::vector<dynamics::Event> left;
    for (const dynamics::Event& e : events) {
      if (e.kind == dynamics::EventKind::kGrazing) continue;
      const auto c = static_cast<std::size_t>(std::max(e.contact, 0));
      const friction::ContactForces law = friction::contact_forces(system_->contacts()[c]);
      if (law.kind == friction::LawKind::kBristle && std::abs(e.force) <= kAtRest * law.most()) continue;
      const auto last = std::find_if(left.rbegin(), left.rend(), [&](const auto& o) { return o.contact == e.contact; });
      const bool grazed = last != left.rend() && e.contact >= 0 && last->before == e.after &&
                          e.time - last->time <= kGrazes * options_.duration;
      if (grazed)
        left.erase(std::next(last).base());
      else
        left.push_back(e);
    }
    return left;
  }

  /// Of contacts that graze, or that move by rounding alone, runs from starts rounded otherwise tell more or fewer, or
  /// at other times, on this side of `end` or that.
  bool events_are_told(double end) {
    dynamics::SimulateOptions options = plain();
    for (int trial = 0; trial < kRounded; ++trial) {
      dynamics::State from = start_;
      for (double& q : from.q) q += kRoundedBy * size_q_ * random_.normal();
      for (double& v : from.v) v += kRoundedBy * size_v_ * random_.normal();
      options.flow.tolerance = kTolerance * std::pow(10.0, random_.uniform(-1.0, 1.0));
      const dynamics::Trajectory run = dynamics::simulate(*system_, from, options);
      const auto as_before = [&](const dynamics::Event& a, const dynamics::Event& b) {
        return std::abs(a.time - b.time) <= std::min(kSameTime * options_.duration, kApart * std::abs(b.time - end));
      };
      if (!std::ranges::equal(run.events, run_.events, as_before)) return false;
    }
    return true;
  }

  /// Distance of two final states, of the run's sizes.
  [[nodiscard]] double distance(const dynamics::State& a, const dynamics::State& b) const {
    // Speeds round by what displacements would become, which may be stretched far more than they move, and by what
    // forces round by for as long as these push; by what a stop that is met from rest makes of the place it is told at;
    // and are off by what the flow's tolerance lets them.
    const double rate = kPhasePerSample / options_.sample;
    const bool stops =
        std::ranges::any_of(system_->contacts(), [](const auto& c) { return friction::clearance(c.law) != nullptr; });
    const double share =
        (64.0 + rate * options_.duration) * std::numeric_limits<double>::epsilon() + (stops ? kTold : 0.0);
    const double rounding = share * size_q_ * rate;
    const double size_v = size_v_ + (rounding + tolerated_) / kSameMotion;
    return std::max((a.q - b.q).cwiseAbs().maxCoeff() / size_q_, (a.v - b.v).cwiseAbs().maxCoeff() / size_v);
  }

  /// From one of the run's events, as it left it: on a guard to rounding.
  void take_up_again() {
    if (events_.empty()) return;
    const auto pick = static_cast<std::size_t>(random_.uniform() * static_cast<double>(events_.size()));
    const dynamics::State& from = events_[pick];
    // Of simultaneous events the last holds the modes of all.
    for (std::size_t later = pick + 1; later < events_.size(); ++later)
      if (events_[later].time == from.time) return;
    dynamics::SimulateOptions options = plain();
    options.duration = start_.time + options_.duration - from.time;
    const dynamics::State end = dynamics::simulate(*system_, from, options).final_state;
    result_.restart = distance(end, run_.final_state);
    if (!(result_.restart <= kSameMotion))
      violate("restart", fmt::format("{:.2g} away after {:.6g} s from the event at t = {:.9g}", result_.restart,
                                     options.duration, from.time));
  }

  /// On all modes of a random basis, and of one that the house makes.
  void reduce() {
    if (system_->size() <= kLargestAtRandom) reduce_at_random();
    const double kind = random_.uniform();
    if (const std::optional<pod::Basis> own = own_basis(kind)) compare(pod::to_string(own->kind), *own);
  }

  void reduce_at_random() {
    const Index n = system_->size();
    Eigen::MatrixXd vectors(n, n);
    for (double& value : vectors.reshaped()) value = random_.normal();
    const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(vectors).householderQ();
    Eigen::VectorXd mean(n);
    for (double& value : mean) value = size_q_ * 0.1 * random_.normal();
    // Columns of mixed lengths on an orthonormal frame in the metric of sizes: beams mix metres and radians.
    const Eigen::VectorXd inertia = fem::to_dense(system_->structure().M()).diagonal().cwiseSqrt();
    for (Index j = 0; j < n; ++j)
      vectors.col(j) = std::exp(random_.uniform(-2.0, 2.0)) * inertia.cwiseInverse().cwiseProduct(Q.col(j));
    mean = mean.cwiseProduct(inertia.cwiseInverse() * inertia.minCoeff());
    compare("random", rom::user_basis(vectors, mean));
  }

  /// One that the house makes, of all modes. None where it has none: structures that float have no static modes, short
  /// motions not all proper orthogonal ones.
  [[nodiscard]] std::optional<pod::Basis> own_basis(double kind) const {
    const fem::Structure& structure = system_->structure();
    const Index n = system_->size();
    try {
      if (beam_ && kind > 0.85) {
        const pod::SensorArray places(*beam_, pod::evenly_spaced(n, beam_->reach()));
        return pod::pomfs(*beam_, places, {places.readings(run_.q)}, {.pod = {.choice = {.modes = n}}}).basis;
      }
      if (kind < 0.25) return rom::lnm_basis(structure, n);
      if (kind < 0.5) return rom::lnm_static_basis(*system_, n - static_cast<Index>(system_->contacts().size()));
      pod::Basis modes = (kind < 0.75 ? pod::pod({run_.q}) : pod::mass_pod({run_.q}, structure.M())).basis;
      return modes.modes() == n ? std::optional(std::move(modes)) : std::nullopt;
    } catch (const InvalidInput&) {
      return std::nullopt;
    }
  }

  void compare(std::string_view name, const pod::Basis& basis) {
    const dynamics::HybridSystem reduced = rom::reduce(*system_, basis);
    const dynamics::State from = rom::restrict_state(system_->structure(), basis, start_);
    const dynamics::Trajectory run = dynamics::simulate(reduced, from, plain());
    const double gap = distance(rom::lift(basis, run.final_state), run_.final_state);
    result_.reduction = std::max(result_.reduction, gap);
    if (!(gap <= kSameMotion))
      violate("all modes", fmt::format("{}: {:.2g} from the full model at the end, {} events against {}", name, gap,
                                       run.events.size(), run_.events.size()));
  }

  /// The scene's run without samples.
  [[nodiscard]] dynamics::SimulateOptions plain() const {
    dynamics::SimulateOptions options = options_;
    options.sample = 0.0;
    options.event_states = false;
    options.flow.audit = false;
    return options;
  }

  Random random_;
  SceneCheck result_;
  std::string text_;
  std::optional<fem::Beam> beam_;
  std::optional<dynamics::HybridSystem> system_;
  dynamics::State start_;
  dynamics::SimulateOptions options_;
  dynamics::Trajectory run_;
  bool simulated_ = false;
  std::vector<dynamics::State> events_;
  double whole_ = 0.0;  ///< the scene's own duration [s]
  double size_q_ = 1.0, size_v_ = 1.0, tolerated_ = 0.0;
};

}  // namespace

SceneCheck check_scene(const std::string& text, std::uint64_t seed, std::uint64_t index) {
  return SceneChecker(text, seed, index).run();
}

SceneCheck check_random_scene(std::uint64_t seed, std::uint64_t index) {
  return check_scene(random_scene_text(seed, index), seed, index);
}

SceneSurvey survey_random_scenes(std::uint64_t seed, std::uint64_t first, std::uint64_t count,
                                 const ParallelOptions& parallel) {
  std::vector<SceneCheck> checks(count);
  rethrow_first(parallel_for(count, parallel, [&](std::size_t i) { checks[i] = check_random_scene(seed, first + i); }));
  SceneSurvey survey;
  Digest digest;
  for (SceneCheck& check : checks) {
    SceneSurvey one{.scenes = 1,
                    .still = check.still ? 1 : 0,
                    .coasting = check.scan.coasts ? 1 : 0,
                    .refused = {},
                    .scan = check.scan,
                    .energy = check.energy,
                    .restart = check.restart,
                    .cut = check.cut,
                    .reduction = check.reduction,
                    .digest = 0,
                    .failed = {}};
    if (!check.refused.empty()) one.refused[check.refused] = 1;
    digest.add(check.digest);
    if (!check.violations.empty()) one.failed.push_back(std::move(check));
    survey.merge(std::move(one));
  }
  survey.digest = digest.value();
  return survey;
}

void SceneSurvey::merge(SceneSurvey next) {
  scenes += next.scenes;
  for (const auto& [reason, count] : next.refused) refused[reason] += count;
  still += next.still;
  coasting += next.coasting;
  scan.merge(next.scan);
  energy = std::max(energy, next.energy);
  restart = std::max(restart, next.restart);
  cut = std::max(cut, next.cut);
  reduction = std::max(reduction, next.reduction);
  Digest both;
  both.add(digest);
  both.add(next.digest);
  digest = both.value();
  failed.insert(failed.end(), next.failed.begin(), next.failed.end());
}

bool same_bytes_on_threads(std::uint64_t seed, std::uint64_t index, int threads, int starts) {
  const auto digests = [&](int count) {
    // A fresh system each time: its modal data and regimes are built by whichever thread comes first.
    const scene::Scene scene = scene::parse_scene(random_scene_text(seed, index));
    const dynamics::HybridSystem system = scene::build_system(scene);
    const dynamics::State start = scene::initial_state(scene, system);
    dynamics::SimulateOptions options = scene::simulate_options(scene);
    options.transient = options.sample = 0.0;
    std::vector<std::uint64_t> result(static_cast<std::size_t>(starts), 0);
    const BatchResult batch = parallel_for(result.size(), {.threads = count}, [&](std::size_t i) {
      dynamics::State from = start;
      from.q *= 1.0 - 0.1 * static_cast<double>(i);
      Digest digest;
      digest.add(dynamics::simulate(system, from, options));
      result[i] = digest.value();
    });
    for (const std::exception_ptr& error : batch.errors) static_cast<void>(error);  // a refused run has digest 0
    return result;
  };
  return digests(threads) == digests(1);
}

}  // namespace slipmode::selftest
