#pragma once

#include <slipmode/dynamics/system.hpp>
#include <slipmode/pod/basis.hpp>
#include <slipmode/scene/scene.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slipmode::trade {

/// In what a configuration differs from its scene.
enum class Axis : std::uint8_t {
  kScene,      ///< in nothing
  kModes,      ///< a reduced model: basis and number of modes
  kFlow,       ///< method and tolerance of the flow
  kTheory,     ///< beam theory
  kElements,   ///< elements of the beam
  kLaw,        ///< contact law: rigid, compliant, regularised
  kLoad,       ///< model of the normal load
  kHarmonics,  ///< of a periodic orbit: order of a balance
  kSamples,    ///< likewise: samples of the alternating scheme
  kMixed,      ///< likewise: order, and reach, of the mixed method
  kCombined,   ///< a reduced model and a tolerance
  kEffect,     ///< effects left out, or one put in
  kLean,       ///< all that can be left out together, as it is written
};

/// "scene", "modes", "flow", "theory", "elements", "law", "load", "harmonics", "samples", "mixed", "combined",
/// "effect", "lean".
[[nodiscard]] std::string_view to_string(Axis axis);

/// A reduced model as [reduction] says it.
struct Reduction {
  scene::BasisChoice basis = scene::BasisChoice::kPom;
  Eigen::Index modes = 0;
};

/// One configuration: a scene, and the reduced model it is run by, if any.
struct Variant {
  std::string name;  ///< "6 pom", "tolerance 1e-06", "rigid contacts"
  Axis axis = Axis::kScene;
  scene::Scene scene;
  std::optional<Reduction> reduction = {};
};

/// A basis on offer, with all vectors that may be used.
struct OfferedBasis {
  scene::BasisChoice choice = scene::BasisChoice::kPom;
  pod::Basis basis;
  double seconds = 0.0;  ///< what making it took: ensemble and decomposition, or natural modes
};

/// The basis a reduced variant is projected on; empty for a full model. Natural modes that are not on offer are those
/// of `full`, about the sliding equilibrium on a belt.
/// @throws InvalidInput  when the basis is not on offer or has fewer vectors
[[nodiscard]] std::optional<pod::Basis> basis_of(const Variant& variant, const std::vector<OfferedBasis>& bases,
                                                 const dynamics::HybridSystem& full);

/// The variant as a scene that the other verbs take: [reduction] says the reduced model. Tables that the variant's
/// scene never had are left out, so that `run` does no more than it did.
/// @throws InvalidInput  for a scene that cannot be read back
[[nodiscard]] std::string scene_text(const Variant& variant);

}  // namespace slipmode::trade
