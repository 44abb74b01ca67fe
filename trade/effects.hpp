#pragma once

#include <slipmode/trade/study.hpp>
#include <slipmode/trade/variant.hpp>

#include <string>
#include <vector>

namespace slipmode::trade {

/// Something a scene models and could leave out.
struct Effect {
  std::string name;  ///< "static friction peak", "mode 3"
  Variant without;   ///< the scene without it
};

/// The effects that a scene names: shear and rotary inertia of a Timoshenko beam, contact springs, bristles, the static
/// friction peak, the Stribeck slope, loads that vary with position or vibrate, tilt, structural damping, damping of
/// stops, the tip's rotary inertia, and each of the first natural modes. What it does not name is not listed.
///
/// Shear is dropped by a shear stiffness 10⁹ times as large. Rotary inertia is dropped by a section 1000 times thinner
/// and wider, of a material as much stiffer: same EI, ρA and κGA, a millionth of ρI. A mode is dropped by projecting on
/// all others, about the sliding equilibrium; of more than 200 degrees of freedom the first 60 stand for all.
[[nodiscard]] std::vector<Effect> effects_of(const scene::Scene& scene);

/// What leaving an effect out comes to.
enum class Verdict {
  kNeeded,   ///< some output changes by more than the limit, and by more than twice its scatter
  kUnclear,  ///< by more than the limit, but no more than twice the scatter
  kSpare,    ///< none changes by more than the limit
  kFailed,   ///< the scene cannot be run without it
};
[[nodiscard]] std::string_view to_string(Verdict verdict);

struct EffectAdvice {
  Verdict verdict = Verdict::kSpare;
  Measure measure = Measure::kDx;  ///< the output that changes most, in units of what it may change by
  double time_share = 1.0;         ///< time of a run without it, of that with it
  std::string sentence = {};
};

/// @param full   the scene with all effects; its cost is what time_share is of
/// @param limit  change that matters [%]
/// @param only   the one output that counts; empty: all
[[nodiscard]] EffectAdvice advise(const Effect& effect, const Row& full, const Row& without, double limit,
                                  std::optional<Measure> only = {});

}  // namespace slipmode::trade
