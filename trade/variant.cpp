#include <slipmode/trade/variant.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/model.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>

namespace slipmode::trade {

namespace {

constexpr std::array<std::string_view, 13> kAxes = {"scene",    "modes",  "flow",      "theory",  "elements",
                                                    "law",      "load",   "harmonics", "samples", "mixed",
                                                    "combined", "effect", "lean"};

/// Fewer elements have fewer modes to compare.
void drop_modes_beyond(scene::Scene& scene) {
  for (std::vector<int>* modes : {&scene.validation.modes, &scene.driven.modes}) {
    std::erase_if(*modes, [&scene](int L) { return L > scene.size(); });
  }
  scene.reduction.choice.modes = std::min(scene.reduction.choice.modes, scene.size());
}

}  // namespace

std::string_view to_string(Axis axis) { return kAxes[static_cast<std::size_t>(axis)]; }

std::optional<pod::Basis> basis_of(const Variant& variant, const std::vector<OfferedBasis>& bases,
                                   const dynamics::HybridSystem& full) {
  if (!variant.reduction) return std::nullopt;
  const auto found = std::ranges::find(bases, variant.reduction->basis, &OfferedBasis::choice);
  if (found == bases.end() && variant.reduction->basis == scene::BasisChoice::kLnm) {
    return diagnostics::lnms_at_rest(full, variant.reduction->modes);
  }
  if (found == bases.end()) {
    throw InvalidInput(fmt::format("{}: basis \"{}\" is not on offer for this scene", variant.name,
                                   scene::to_string(variant.reduction->basis)));
  }
  return found->basis.truncated(variant.reduction->modes);
}

std::string scene_text(const Variant& variant) {
  scene::Scene scene = variant.scene;
  if (variant.reduction) {
    scene.reduction.basis = variant.reduction->basis;
    scene.reduction.choice.modes = variant.reduction->modes;
    scene.source.given.insert("reduction");
  }
  drop_modes_beyond(scene);
  std::string text = scene::scene_file(scene);
  (void)scene::parse_scene(text);
  return text;
}

}  // namespace slipmode::trade
