#include <slipmode/trade/effects.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/friction/simplified.hpp>
#include <slipmode/trade/variants.hpp>
#include "trade/internal/laws.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <utility>

namespace slipmode::trade {

namespace {

constexpr std::array<std::string_view, 5> kKinds = {"law", "theory", "discretisation", "precision", "addition"};
/// Contacts up to which each has effects of its own.
constexpr std::size_t kContactsApart = 4;
/// More natural modes than this are known badly by any mesh: `slipmode reduce` takes no more of a beam's.
constexpr Eigen::Index kMostModes = 40;
constexpr std::array kLooseTolerances = {1e-6, 1e-3};
constexpr double kStiffSpring = 100.0;

using Changed = std::optional<scene::Scene>;
using Change = std::function<Changed(const scene::Scene&)>;

scene::Scene with_one_contact(const scene::Scene& scene, std::size_t c) {
  scene::Scene one = scene;
  one.contacts = {scene.contacts[c]};
  return one;
}

/// A change of all contacts, made to one.
Change at_contact(std::size_t c, const Change& change) {
  return [c, change](const scene::Scene& scene) -> Changed {
    const Changed one = change(with_one_contact(scene, c));
    if (!one) return std::nullopt;
    scene::Scene other = scene;
    other.contacts[c] = one->contacts.front();
    return other;
  };
}

Changed with_theory(scene::Scene scene, fem::BeamTheory theory) {
  if (scene.beam() == nullptr || scene.beam()->theory == theory) return std::nullopt;
  std::get<fem::BeamOptions>(scene.structure).theory = theory;
  return scene;
}

/// Nothing for a beam of Euler and Bernoulli, which uses neither.
template <class ChangeSpan>
Changed with_spans(scene::Scene scene, const ChangeSpan& change) {
  if (scene.beam() == nullptr || scene.beam()->theory != fem::BeamTheory::kTimoshenko) return std::nullopt;
  std::ranges::for_each(std::get<fem::BeamOptions>(scene.structure).spans, change);
  return scene;
}

Changed without_shear(const scene::Scene& scene) {
  return with_spans(scene, [](fem::BeamSpan& span) { span.shear_coefficient *= 1e9; });
}

Changed without_rotary_inertia(const scene::Scene& scene) {
  return with_spans(scene, [](fem::BeamSpan& span) {
    constexpr double kThinner = 1e3;
    span.width *= kThinner;
    span.thickness /= kThinner;
    span.youngs_modulus *= kThinner * kThinner;
    span.shear_coefficient /= kThinner * kThinner;
  });
}

Changed without_tip(const scene::Scene& scene, double fem::TipBody::*number) {
  if (scene.beam() == nullptr || scene.beam()->tip.*number == 0.0) return std::nullopt;
  scene::Scene other = scene;
  std::get<fem::BeamOptions>(other.structure).tip.*number = 0.0;
  return other;
}

Changed without_tilt(const scene::Scene& scene) {
  return with_contacts(scene, [](scene::ContactSpec& contact) { return std::exchange(contact.tilt_deg, 0.0) != 0.0; });
}

/// Rigid ones where contacts are of that kind.
Change rigid_instead_of(friction::LawKind kind) {
  return [kind](const scene::Scene& scene) {
    return with_laws(scene, [kind](const friction::Law& law) {
      return friction::kind(law) == kind ? friction::rigid(law) : std::nullopt;
    });
  };
}

Changed with_stiff_springs(const scene::Scene& scene) {
  const bool any = std::ranges::any_of(scene.contacts, [](const scene::ContactSpec& contact) {
    return friction::kind(contact.law) == friction::LawKind::kConstant;
  });
  return any ? with_springs(scene, kStiffSpring) : std::nullopt;
}

bool undamped(fem::ChainOptions& chain) {
  const bool any = chain.damping > 0.0 || chain.mass_damping > 0.0;
  chain.damping = chain.mass_damping = 0.0;
  return any;
}
bool undamped(fem::BeamOptions& beam) {
  const auto* rayleigh = std::get_if<fem::Rayleigh>(&beam.damping);
  const bool any = rayleigh == nullptr || rayleigh->mass > 0.0 || rayleigh->stiffness > 0.0;
  beam.damping = fem::Rayleigh{};
  return any;
}
bool undamped(fem::MassesOptions& masses) {
  bool any = false;
  for (auto& link : masses.links) {
    any = any || link.damping > 0.0;
    link.damping = 0.0;
  }
  return any;
}
bool undamped(scene::MatricesSpec& matrices) {
  const bool any = matrices.damping.size() > 0 && !matrices.damping.isZero(0.0);
  matrices.damping.setZero();
  return any;
}

Changed without_damping(const scene::Scene& scene) {
  scene::Scene other = scene;
  const bool any = std::visit([](auto& structure) { return undamped(structure); }, other.structure);
  return any ? Changed(std::move(other)) : std::nullopt;
}

class Effects {
 public:
  explicit Effects(const scene::Scene& scene) : scene_(scene) {}

  std::vector<Effect> list() {
    of_contacts();
    offer({.name = "structural damping"}, without_damping);
    of_beam();
    of_elements();
    of_modes();
    of_flow();
    const auto of_missing = [this](const char* name, Change change) {
      offer({.name = name, .kind = EffectKind::kAddition, .removable = false}, std::move(change));
    };
    of_missing("Timoshenko's theory", [](const auto& s) { return with_theory(s, fem::BeamTheory::kTimoshenko); });
    of_missing("springs behind rigid contacts", with_stiff_springs);
    return std::move(all_);
  }

 private:
  /// Where the scene has it and can be run without.
  /// @param effect  all but its change
  void offer(Effect effect, Change change) {
    const Changed other = change(scene_);
    if (!other || !can_run(*other)) return;
    effect.change = [change = std::move(change)](const scene::Scene& s) { return change(s).value_or(s); };
    all_.push_back(std::move(effect));
  }

  void of_contacts() {
    const std::vector<std::pair<std::string, Change>> changes = {
        {"contact compliance", rigid_instead_of(friction::LawKind::kCompliant)},
        {"bristles", rigid_instead_of(friction::LawKind::kBristle)},
        {"static friction peak", [](const auto& s) { return with_laws(s, friction::without_static_peak); }},
        {"Stribeck slope", [](const auto& s) { return with_laws(s, friction::without_stribeck_slope); }},
        {"position-dependent load", with_constant_load},
        {"normal vibration", without_normal_vibration},
        {"tilt of the slider", without_tilt},
        {"damping of the stops", [](const auto& s) { return with_laws(s, friction::without_stop_damping); }}};
    for (const auto& [name, change] : changes) {
      std::vector<std::size_t> having;
      for (std::size_t c = 0; c < scene_.contacts.size(); ++c) {
        if (change(with_one_contact(scene_, c))) having.push_back(c);
      }
      if (having.size() < 2 || having.size() > kContactsApart) {
        offer({.name = name}, change);
        continue;
      }
      for (const std::size_t c : having) {
        offer({.name = fmt::format("{} of {}", name, scene_.contacts[c].name)}, at_contact(c, change));
      }
    }
  }

  void of_beam() {
    const auto of_theory = [this](const char* name, Change change, bool removable = true) {
      offer({.name = name, .kind = EffectKind::kTheory, .removable = removable}, std::move(change));
    };
    of_theory("shear", without_shear, false);
    of_theory("rotary inertia", without_rotary_inertia, false);
    of_theory("Timoshenko's theory", [](const auto& s) { return with_theory(s, fem::BeamTheory::kEulerBernoulli); });
    of_theory("tip inertia", [](const auto& s) { return without_tip(s, &fem::TipBody::inertia); });
    of_theory("tip offset", [](const auto& s) { return without_tip(s, &fem::TipBody::offset); });
  }

  void of_elements() {
    std::vector<Variant> meshes =
        scene_.beam() == nullptr ? std::vector<Variant>() : along(Axis::kElements, scene_, {});
    std::ranges::sort(meshes, std::greater(), [](const Variant& mesh) { return mesh.scene.size(); });
    for (const Variant& mesh : meshes) {
      const Change change = [spans = mesh.scene.beam()->spans](const scene::Scene& s) -> Changed {
        scene::Scene other = s;
        auto& own = std::get<fem::BeamOptions>(other.structure).spans;
        for (std::size_t i = 0; i < own.size(); ++i) own[i].elements = spans[i].elements;
        return other;
      };
      offer({.name = "more than " + mesh.name, .kind = EffectKind::kDiscretisation, .ladder = "elements"}, change);
    }
  }

  void of_modes() {
    std::vector<Eigen::Index> sizes = thinned_sizes(std::min(scene_.size() - 1, kMostModes));
    std::ranges::reverse(sizes);
    for (const Eigen::Index modes : sizes) {
      all_.push_back({.name = fmt::format("modes above {}", modes),
                      .kind = EffectKind::kDiscretisation,
                      .change = [](const scene::Scene& s) { return s; },
                      .modes = modes,
                      .ladder = "modes"});
    }
  }

  void of_flow() {
    std::vector<Variant> flows = along(Axis::kFlow, scene_, {});
    std::ranges::sort(flows, {}, [](const Variant& flow) { return flow.scene.flow.tolerance; });
    for (const Variant& flow : flows) {
      const dynamics::FlowOptions& other = flow.scene.flow;
      const bool looser = other.method == scene_.flow.method && other.tolerance > scene_.flow.tolerance;
      if (!looser || std::ranges::find(kLooseTolerances, other.tolerance) == kLooseTolerances.end()) continue;
      const Change change = [other](const scene::Scene& s) -> Changed {
        scene::Scene loose = s;
        loose.flow = other;
        return loose;
      };
      offer({.name = fmt::format("tolerance below {:.0e}", other.tolerance),
             .kind = EffectKind::kPrecision,
             .ladder = "tolerance"},
            change);
    }
  }

  const scene::Scene& scene_;
  std::vector<Effect> all_;
};

}  // namespace

std::string_view to_string(EffectKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

std::vector<Effect> effects_of(const scene::Scene& scene) { return Effects(scene).list(); }

std::vector<std::size_t> furthest(const std::vector<Effect>& effects, std::vector<std::size_t> set) {
  std::ranges::sort(set);
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < set.size(); ++k) {
    const std::string& ladder = effects[set[k]].ladder;
    const bool passed = !ladder.empty() && std::any_of(set.begin() + static_cast<std::ptrdiff_t>(k) + 1, set.end(),
                                                       [&](std::size_t e) { return effects[e].ladder == ladder; });
    if (!passed) out.push_back(set[k]);
  }
  return out;
}

Variant without(const scene::Scene& scene, const std::vector<Effect>& effects, const std::vector<std::size_t>& set) {
  Variant out{.name = "", .axis = Axis::kEffect, .scene = scene};
  for (const std::size_t e : furthest(effects, set)) {
    const Effect& effect = effects[e];
    const std::string word = effect.kind == EffectKind::kAddition ? "with " : "without ";
    out.name += (out.name.empty() ? word : ", ") + effect.name;
    out.scene = effect.change(out.scene);
    if (effect.modes > 0) out.reduction = Reduction{.basis = scene::BasisChoice::kLnm, .modes = effect.modes};
  }
  // Fewer elements have fewer modes to leave out.
  if (out.reduction && out.reduction->modes >= out.scene.size()) out.reduction.reset();
  return out;
}

}  // namespace slipmode::trade
