#include <slipmode/trade/effects.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/attractors/model.hpp>
#include <slipmode/friction/simplified.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/trade/advice.hpp>
#include "trade/internal/laws.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

namespace slipmode::trade {

namespace {

constexpr Eigen::Index kModesTried = 10;
constexpr Eigen::Index kMostModes = 60;
constexpr Eigen::Index kSmall = 200;

class Effects {
 public:
  explicit Effects(const scene::Scene& scene) : scene_(scene) {}

  std::vector<Effect> list() {
    of_beam();
    of_contacts();
    of_damping();
    of_modes();
    return std::move(all_);
  }

 private:
  void offer(const std::string& name, const std::optional<scene::Scene>& without) {
    if (!without || !can_run(*without)) return;
    all_.push_back({name, {.name = "without " + name, .axis = Axis::kEffect, .scene = *without}});
  }

  void of_beam() {
    if (scene_.beam() == nullptr) return;
    if (scene_.beam()->theory == fem::BeamTheory::kTimoshenko) {
      offer("shear", with_spans([](fem::BeamSpan& span) { span.shear_coefficient *= 1e9; }));
      offer("rotary inertia", with_spans([](fem::BeamSpan& span) {
              constexpr double kThinner = 1e3;
              span.width *= kThinner;
              span.thickness /= kThinner;
              span.youngs_modulus *= kThinner * kThinner;
              span.shear_coefficient /= kThinner * kThinner;
            }));
    }
    if (scene_.beam()->tip.inertia > 0.0) {
      scene::Scene other = scene_;
      std::get<fem::BeamOptions>(other.structure).tip.inertia = 0.0;
      offer("tip inertia", other);
    }
  }

  template <class Change>
  [[nodiscard]] scene::Scene with_spans(const Change& change) const {
    scene::Scene other = scene_;
    std::ranges::for_each(std::get<fem::BeamOptions>(other.structure).spans, change);
    return other;
  }

  void of_contacts() {
    const auto has = [this](friction::LawKind kind) {
      return std::ranges::any_of(scene_.contacts,
                                 [kind](const scene::ContactSpec& own) { return friction::kind(own.law) == kind; });
    };
    if (has(friction::LawKind::kCompliant)) offer("contact compliance", with_rigid_contacts(scene_));
    if (has(friction::LawKind::kBristle)) offer("bristles", with_rigid_contacts(scene_));
    offer("static friction peak", with_laws(scene_, friction::without_static_peak));
    offer("Stribeck slope", with_laws(scene_, friction::without_stribeck_slope));
    offer("position-dependent load", with_constant_load(scene_));
    offer("normal vibration", without_normal_vibration(scene_));
    offer("tilt of the slider", with_contacts(scene_, [](scene::ContactSpec& contact) {
            return std::exchange(contact.tilt_deg, 0.0) != 0.0;
          }));
    offer("damping of the stops", with_laws(scene_, friction::without_stop_damping));
  }

  void of_damping() {
    scene::Scene other = scene_;
    const bool any = std::visit([](auto& structure) { return undamped(structure); }, other.structure);
    if (any) offer("structural damping", other);
  }

  static bool undamped(fem::ChainOptions& chain) {
    const bool any = chain.damping > 0.0 || chain.mass_damping > 0.0;
    chain.damping = chain.mass_damping = 0.0;
    return any;
  }
  static bool undamped(fem::BeamOptions& beam) {
    const auto* rayleigh = std::get_if<fem::Rayleigh>(&beam.damping);
    const bool any = rayleigh == nullptr || rayleigh->mass > 0.0 || rayleigh->stiffness > 0.0;
    beam.damping = fem::Rayleigh{};
    return any;
  }
  static bool undamped(fem::MassesOptions& masses) {
    bool any = false;
    for (auto& link : masses.links) {
      any = any || link.damping > 0.0;
      link.damping = 0.0;
    }
    return any;
  }
  static bool undamped(scene::MatricesSpec& matrices) {
    const bool any = matrices.damping.size() > 0 && !matrices.damping.isZero(0.0);
    matrices.damping.setZero();
    return any;
  }

  void of_modes() {
    const dynamics::HybridSystem system = scene::build_system(scene_);
    const Eigen::Index n = system.size();
    if (n < 2) return;
    const Eigen::Index count = n <= kSmall ? n : kMostModes;
    pod::Basis all = rom::lnm_basis(system.structure(), count);
    all.mean = resting_place(system);
    for (Eigen::Index k = 0; k < std::min(kModesTried, count); ++k) {
      std::vector<Eigen::Index> kept;
      for (Eigen::Index i = 0; i < count; ++i) {
        if (i != k) kept.push_back(i);
      }
      offer_basis(fmt::format("mode {}", k + 1), all, all.vectors(Eigen::all, kept));
    }
    if (count > kModesTried) {
      offer_basis(fmt::format("modes above {}", kModesTried), all, all.vectors.leftCols(kModesTried));
    }
  }

  void offer_basis(const std::string& name, pod::Basis like, const Eigen::MatrixXd& vectors) {
    like.vectors = vectors;
    like.energy.resize(0);
    all_.push_back(
        {name, {.name = "without " + name, .axis = Axis::kEffect, .scene = scene_, .basis = std::move(like)}});
  }

  /// Where belts hold the structure on average; elsewhere zero.
  [[nodiscard]] Eigen::VectorXd resting_place(const dynamics::HybridSystem& system) const {
    if (scene_.drive.belt() == nullptr) return Eigen::VectorXd::Zero(system.size());
    try {
      return diagnostics::sliding_equilibrium(system).q;
    } catch (const InvalidInput&) {
      return Eigen::VectorXd::Zero(system.size());
    }
  }

  const scene::Scene& scene_;
  std::vector<Effect> all_;
};

/// Change of an output in units of what it may change by.
double weight(double error, double noise, double limit) { return error / std::max(limit, 2.0 * noise); }

std::string time_text(double share) {
  constexpr double kSame = 0.05;
  if (!std::isfinite(share)) return "its time is not known";
  if (std::abs(share - 1.0) < kSame) return "a run takes as long";
  return fmt::format("a run takes {:.2g} of the time", share);
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kNeeded:
      return "needed";
    case Verdict::kUnclear:
      return "unclear";
    case Verdict::kSpare:
      return "can be left out";
    case Verdict::kFailed:
      return "cannot be run without";
  }
  return "";
}

std::vector<Effect> effects_of(const scene::Scene& scene) { return Effects(scene).list(); }

EffectAdvice advise(const Effect& effect, const Row& full, const Row& without, double limit,
                    std::optional<Measure> only) {
  EffectAdvice out{.time_share = without.cost.cpu / full.cost.cpu};
  if (!without.failure.empty()) {
    out.verdict = Verdict::kFailed;
    out.sentence = fmt::format("{}: the scene cannot be run without it: {}", effect.name, without.failure);
    return out;
  }
  double largest = -1.0;
  bool above = false;
  for (std::size_t m = 0; m < kMeasures; ++m) {
    const double error = without.error[m], noise = without.noise[m];
    if (std::isnan(error) || (only && static_cast<std::size_t>(*only) != m)) continue;
    above = above || error > limit;
    if (const double found = weight(error, noise, limit); found > largest) {
      largest = found;
      out.measure = static_cast<Measure>(m);
    }
  }
  out.verdict = largest > 1.0 ? Verdict::kNeeded : above ? Verdict::kUnclear : Verdict::kSpare;
  out.sentence =
      fmt::format("{}: {}; without it {} is off most, by {} % (scatter {} %), and {}", effect.name,
                  to_string(out.verdict), to_string(out.measure), percent_text(at(without.error, out.measure)),
                  percent_text(at(without.noise, out.measure)), time_text(out.time_share));
  return out;
}

}  // namespace slipmode::trade
