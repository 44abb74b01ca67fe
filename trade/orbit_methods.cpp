#include <slipmode/trade/orbit_methods.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/median.hpp>
#include <slipmode/core/timing.hpp>
#include <slipmode/orbits/mixed/certificate.hpp>
#include <slipmode/trade/advice.hpp>
#include <slipmode/trade/variants.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <variant>

namespace slipmode::trade {
namespace {

using dynamics::HybridSystem;
using Approximation = std::variant<orbits::Balance, orbits::MixedOrbit>;

bool balances_hold(const HybridSystem& system) {
  try {
    static_cast<void>(orbits::balance(system, {.harmonics = 1, .max_iterations = 1}));
    return true;
  } catch (const InvalidInput&) {
    return false;
  }
}

/// Steps from the contacts within which there still is a rest, of those tried.
std::vector<int> reaches(const HybridSystem& system) {
  std::vector<int> out;
  try {
    static_cast<void>(orbits::least_harmonics(system, {}));
  } catch (const InvalidInput&) {
    return out;
  }
  for (const int reach : {0, 1})
    if (std::ssize(orbits::near_dofs(system, reach)) < system.size()) out.push_back(reach);
  return out;
}

Approximation solved(const HybridSystem& system, const OrbitMethod& method) {
  if (method.axis == Axis::kMixed)
    return orbits::mixed_orbit(system, {.harmonics = method.harmonics, .reach = method.near});
  return orbits::balance(system, {.harmonics = method.harmonics, .samples = method.samples});
}

/// From what the scene settles to, as `slipmode orbit find` begins.
orbits::ShootingResult shot(const scene::Scene& scene, const HybridSystem& system) {
  const double periods = scene.time.transient / *system.drive().period();
  orbits::ShootingOptions options;
  options.flow.method = scene.flow.method;
  return orbits::shoot(system, orbits::settle_guess(system, scene::initial_state(scene, system), std::round(periods)),
                       options);
}

class OrbitWork {
 public:
  OrbitWork(const scene::Scene& scene, const std::vector<OrbitMethod>& methods, int repeats,
            const ParallelOptions& options)
      : scene_(scene), system_(scene::build_system(scene)), methods_(methods), repeats_(repeats), options_(options) {}

  OrbitStudy run() {
    times_.resize(methods_.size() + 1);
    guarded(out_.reference, [&] {
      known_ = shot(scene_, system_);
      if (!known_->converged()) out_.reference.failure = known_->message;
    });
    out_.reference.name = "shooting, settling included";
    out_.reference.options = "--by shooting";
    if (out_.reference.failure.empty()) {
      out_.word = known_->orbit.word;
      out_.reference.error = 0.0;
    } else {
      known_.reset();
    }
    for (const OrbitMethod& method : methods_) {
      OrbitRow& row =
          out_.rows.emplace_back(OrbitRow{.name = method.name(), .options = method.options(), .axis = method.axis});
      std::optional<Approximation> found;
      guarded(row, [&] { found = solved(system_, method); });
      if (found) std::visit([&](const auto& own) { judge(own, row); }, *found);
    }
    for (int k = 1; k < repeats_; ++k) {
      again(out_.reference, 0, [&] { static_cast<void>(shot(scene_, system_)); });
      for (std::size_t i = 0; i < methods_.size(); ++i)
        again(out_.rows[i], i + 1, [&] { static_cast<void>(solved(system_, methods_[i])); });
    }
    put_times(out_.reference, 0);
    for (std::size_t i = 0; i < methods_.size(); ++i) put_times(out_.rows[i], i + 1);
    return std::move(out_);
  }

 private:
  /// Timed, the first time; a failure is the row's.
  template <class Solve>
  void guarded(OrbitRow& out_row, const Solve& solve) {
    step();
    try {
      times_[out_.rows.size()].push_back(timed(solve).cpu);
    } catch (const NumericalFailure& failure) {
      out_row.failure = failure.what();
    } catch (const InvalidInput& refusal) {
      out_row.failure = refusal.what();
    }
  }

  template <class Solve>
  void again(const OrbitRow& row, std::size_t place, const Solve& solve) {
    constexpr double kLong = 0.1;  // [s]
    step();
    if (!row.failure.empty() || times_[place].front() > kLong) return;
    times_[place].push_back(timed(solve).cpu);
  }

  void step() {
    if (options_.stop != nullptr && options_.stop->load()) throw Interrupted();
    if (options_.progress) options_.progress(std::min(++done_, total()), total());
  }
  [[nodiscard]] std::size_t total() const { return (methods_.size() + 1) * static_cast<std::size_t>(repeats_); }

  template <class Own>
  void judge(const Own& own, OrbitRow& out_row) const {
    if (!own.converged) {
      out_row.failure = own.message;
      return;
    }
    orbits::Certificate certificate;
    // Of a family of orbits a method need not find the same one.
    const bool family = known_ && known_->orbit.family.cols() > 0;
    if (known_ && !family) certificate = orbits::compare(system_, own, *known_);
    if (!certificate.behind) {
      certificate = orbits::certify(system_, own);
      const orbits::PeriodicOrbit& behind = certificate.found.orbit;
      const bool same = !known_ || (family && behind.word == known_->orbit.word);
      if (certificate.behind && !same) out_row.other = behind.word;
    }
    if (certificate.behind)
      out_row.error = 100.0 * certificate.relative;
    else
      out_row.failure = certificate.verdict;
  }

  void put_times(OrbitRow& out_row, std::size_t place) const {
    if (times_[place].empty()) return;
    out_row.cpu = median(times_[place]);
    const auto [low, high] = std::ranges::minmax(times_[place]);
    out_row.cpu_low = low;
    out_row.cpu_high = high;
  }

  const scene::Scene& scene_;
  HybridSystem system_;
  const std::vector<OrbitMethod>& methods_;
  int repeats_;
  const ParallelOptions& options_;
  std::optional<orbits::ShootingResult> known_;
  std::vector<std::vector<double>> times_;  ///< of the reference, then of each method [s of processor]
  std::size_t done_ = 0;
  OrbitStudy out_;
};

}  // namespace

std::string OrbitMethod::name() const {
  const std::string orders = fmt::format("{} harmonic{}", harmonics, harmonics == 1 ? "" : "s");
  if (axis == Axis::kMixed) return fmt::format("mixed, {}{}", orders, near > 0 ? fmt::format(", near {}", near) : "");
  return fmt::format("balance, {}{}", orders, samples > 0 ? fmt::format(", {} samples", samples) : "");
}

std::string OrbitMethod::options() const {
  if (axis == Axis::kMixed)
    return fmt::format("--by mixed --harmonics {}{}", harmonics, near > 0 ? fmt::format(" --near {}", near) : "");
  return fmt::format("--by balance --harmonics {}{}", harmonics,
                     samples > 0 ? fmt::format(" --samples {}", samples) : "");
}

std::vector<OrbitMethod> orbit_methods(Axis axis, const scene::Scene& scene) {
  constexpr std::array kOrders = {1, 3, 5, 9, 15, 25, 49};
  constexpr std::array kSampleCounts = {64, 128, 256, 512, 1024};
  constexpr int kSampledOrder = 25, kMostMixed = 25, kMostWide = 9;  // a step costs the third power
  const bool is_one = axis == Axis::kHarmonics || axis == Axis::kSamples || axis == Axis::kMixed;
  if (!is_one || !scene.drive.period() || scene.size() > kAffordableSize) return {};
  const HybridSystem system = scene::build_system(scene);
  std::vector<OrbitMethod> all;
  if (axis == Axis::kMixed) {
    for (const int reach : reaches(system))
      for (const int order : kOrders)
        if (order <= (reach > 0 ? kMostWide : kMostMixed))
          all.push_back({.axis = axis, .harmonics = order, .near = reach});
    return all;
  }
  if (!balances_hold(system)) return {};
  if (axis == Axis::kHarmonics)
    for (const int order : kOrders) all.push_back({.axis = axis, .harmonics = order});
  else
    for (const int samples : kSampleCounts)
      all.push_back({.axis = axis, .harmonics = kSampledOrder, .samples = samples});
  return all;
}

OrbitStudy study_orbits(const scene::Scene& scene, const std::vector<OrbitMethod>& methods, int repeats,
                        const ParallelOptions& options) {
  if (repeats < 1) throw InvalidInput(fmt::format("repeats: {}; valid: 1 or more", repeats));
  return OrbitWork(scene, methods, repeats, options).run();
}

std::string recommendation(const OrbitStudy& study, double limit) {
  const OrbitRow* best = nullptr;
  for (const OrbitRow& row : study.rows)
    if (row.other.empty() && row.error <= limit && (best == nullptr || row.cpu < best->cpu)) best = &row;
  const std::string asked = fmt::format("for the periodic orbit under {} % use", percent_text(limit));
  const double exact = study.reference.cpu;
  if (best == nullptr || (study.reference.failure.empty() && !(best->cpu < exact)))
    return fmt::format("{} shooting: exact, and nothing faster that was tried will do", asked);
  const std::string faster = study.reference.failure.empty()
                                 ? fmt::format("{} times faster than shooting", percent_text(exact / best->cpu))
                                 : "shooting from what the scene settles to finds none";
  return fmt::format("{} {} ({} %): {}", asked, best->options, percent_text(best->error), faster);
}

}  // namespace slipmode::trade
