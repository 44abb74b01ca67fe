#include <slipmode/trade/variant.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/attractors/model.hpp>
#include <slipmode/rom/reduce.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>

namespace slipmode::trade {

namespace {

constexpr std::array<std::string_view, 13> kAxes = {"scene",    "modes",  "flow",      "theory",  "elements",
                                                    "law",      "load",   "harmonics", "samples", "mixed",
                                                    "combined", "effect", "lean"};

/// True when the scene, or an override of it, has that table, be it a seed alone.
bool has_table(const scene::Scene& scene, const std::string& name) {
  return scene::has_section(scene, name) || scene.source.given.contains(name + ".seed");
}

/// A table of scene_to_toml's text cut out: it goes from its head to the next one.
void cut_table(std::string& text, const std::string& name) {
  const std::size_t begin = text.find("\n[" + name + "]\n");
  if (begin == std::string::npos) return;
  const std::size_t end = text.find("\n[", begin + 1);
  text.erase(begin, end == std::string::npos ? std::string::npos : end - begin);
}

/// Fewer elements have fewer modes to compare.
void drop_modes_beyond(scene::Scene& scene) {
  for (std::vector<int>* modes : {&scene.validation.modes, &scene.shaken.modes}) {
    std::erase_if(*modes, [&scene](int L) { return L > scene.size(); });
  }
  scene.reduction.choice.modes = std::min(scene.reduction.choice.modes, scene.size());
}

/// Where a belt holds the structure on average; elsewhere zero.
Eigen::VectorXd resting_place(const dynamics::HybridSystem& system) {
  if (system.drive().belt() == nullptr) return Eigen::VectorXd::Zero(system.size());
  try {
    return diagnostics::sliding_equilibrium(system).q;
  } catch (const InvalidInput&) {
    return Eigen::VectorXd::Zero(system.size());
  }
}

}  // namespace

std::string_view to_string(Axis axis) { return kAxes[static_cast<std::size_t>(axis)]; }

std::optional<pod::Basis> basis_of(const Variant& variant, const std::vector<OfferedBasis>& bases,
                                   const dynamics::HybridSystem& full) {
  if (!variant.reduction) return std::nullopt;
  const auto found = std::ranges::find(bases, variant.reduction->basis, &OfferedBasis::choice);
  if (found == bases.end() && variant.reduction->basis == scene::BasisChoice::kLnm) {
    pod::Basis modes = rom::lnm_basis(full.structure(), variant.reduction->modes);
    modes.mean = resting_place(full);
    return modes;
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
  }
  drop_modes_beyond(scene);
  std::string text = scene::scene_to_toml(scene);
  for (const char* table : {"initial", "ensemble", "reduction", "validation"}) {
    const bool said = std::string_view(table) == "reduction" && variant.reduction;
    if (!said && !has_table(scene, table)) cut_table(text, table);
  }
  (void)scene::parse_scene(text);
  return text;
}

}  // namespace slipmode::trade
