#pragma once

#include <slipmode/trade/variant.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace slipmode::trade {

enum class EffectKind : std::uint8_t {
  kLaw,             ///< of contacts, their loads, damping
  kTheory,          ///< of the beam and its tip
  kDiscretisation,  ///< elements, modes
  kPrecision,       ///< tolerance of the flow
  kAddition,        ///< what the scene leaves out
};

/// "law", "theory", "discretisation", "precision", "addition".
[[nodiscard]] std::string_view to_string(EffectKind kind);

/// Something a scene models and could leave out; or leaves out and could model (kAddition).
struct Effect {
  std::string name;  ///< "static friction peak", "modes above 3"
  EffectKind kind = EffectKind::kLaw;
  /// The scene without the effect, or with an addition. The scene given may lack other effects already.
  std::function<scene::Scene(const scene::Scene&)> change = {};
  Eigen::Index modes = 0;   ///< natural modes that remain; 0: all
  std::string ladder = {};  ///< effects that go ever further in one direction, in order: "modes", "elements", ...
  bool removable = true;    ///< false: measured alone, as no key of a scene says it, or it is an addition
};

/// The effects that a scene names: Timoshenko's theory, shear and rotary inertia of it, the tip's rotary inertia and
/// offset; contact springs, bristles, the static friction peak, the Stribeck slope, loads that vary with position or
/// vibrate, tilt, damping of stops, contact by contact up to four; structural damping; elements beyond a half, a
/// quarter and an eighth; natural modes beyond a few numbers; a tolerance below 10⁻⁶ and 10⁻³. Then what it leaves out
/// and could model: Timoshenko's theory on a thin beam, springs of a hundred times the structure's stiffness on rigid
/// Coulomb contacts.
///
/// Shear is dropped by a shear stiffness 10⁹ times as large. Rotary inertia is dropped by a section 1000 times thinner
/// and wider, of a material as much stiffer: same EI, ρA and κGA, a millionth of ρI.
[[nodiscard]] std::vector<Effect> effects_of(const scene::Scene& scene);

/// The scene without all effects of a set: one row of a study, named after them in the order of the list. What another
/// one of the set goes further than is not named. Natural modes are kLnm's.
/// @param set  numbers of effects, ascending, not empty; or one addition alone
[[nodiscard]] Variant without(const scene::Scene& scene, const std::vector<Effect>& effects,
                              const std::vector<std::size_t>& set);

/// The set without those that another one of it goes further than, ascending.
[[nodiscard]] std::vector<std::size_t> furthest(const std::vector<Effect>& effects, std::vector<std::size_t> set);

}  // namespace slipmode::trade
