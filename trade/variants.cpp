#include <slipmode/trade/variants.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/prepare.hpp>
#include <slipmode/trade/orbit_methods.hpp>
#include "trade/internal/laws.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace slipmode::trade {

namespace {

using dynamics::FlowMethod;

constexpr std::array kTolerances = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10};
constexpr std::array kMeshes = {0.125, 0.25, 0.5};
constexpr std::size_t kMostSizes = 12;

bool can_run_with(const dynamics::HybridSystem& system, FlowMethod method) {
  try {
    (void)dynamics::choose_method(system, method);
    return true;
  } catch (const InvalidInput&) {
    return false;
  }
}

int elements_of(const fem::BeamOptions& beam) {
  int sum = 0;
  for (const fem::BeamSpan& span : beam.spans) sum += span.elements;
  return sum;
}

scene::Scene with_mesh(const scene::Scene& scene, double factor) {
  scene::Scene other = scene;
  for (fem::BeamSpan& span : std::get<fem::BeamOptions>(other.structure).spans) {
    span.elements = std::max(1, static_cast<int>(std::lround(factor * span.elements)));
  }
  return other;
}

std::vector<Variant> flows(const scene::Scene& scene) {
  const dynamics::HybridSystem system = scene::build_system(scene);
  const FlowMethod own = dynamics::choose_method(system, scene.flow.method);
  std::vector<Variant> all;
  if (own != FlowMethod::kClosedForm && can_run_with(system, FlowMethod::kClosedForm)) {
    all.push_back({.name = "closed form", .axis = Axis::kFlow, .scene = scene});
    all.back().scene.flow.method = FlowMethod::kClosedForm;
  }
  // Springs and stops in closed form are exact, and collocated no cheaper.
  const auto elaborate = [](const friction::Contact& contact) { return contact_forces(contact).is_elaborate(); };
  if (own == FlowMethod::kClosedForm && std::ranges::any_of(system.contacts(), elaborate)) return all;
  if (!can_run_with(system, FlowMethod::kCollocation)) return all;
  for (const double tolerance : kTolerances) {
    if (own == FlowMethod::kCollocation && tolerance == scene.flow.tolerance) continue;
    all.push_back({.name = fmt::format("tolerance {:.0e}", tolerance), .axis = Axis::kFlow, .scene = scene});
    all.back().scene.flow.tolerance = tolerance;
    if (own != FlowMethod::kCollocation) all.back().scene.flow.method = FlowMethod::kCollocation;
  }
  return all;
}

std::vector<Variant> theories(const scene::Scene& scene) {
  if (scene.beam() == nullptr) return {};
  const bool simple = scene.beam()->theory == fem::BeamTheory::kEulerBernoulli;
  Variant other{.name = simple ? "timoshenko" : "euler-bernoulli", .axis = Axis::kTheory, .scene = scene};
  std::get<fem::BeamOptions>(other.scene.structure).theory =
      simple ? fem::BeamTheory::kTimoshenko : fem::BeamTheory::kEulerBernoulli;
  return {other};
}

std::vector<Variant> meshes(const scene::Scene& scene) {
  if (scene.beam() == nullptr) return {};
  std::vector<Variant> all;
  std::vector<int> seen = {elements_of(*scene.beam())};
  for (const double factor : kMeshes) {
    const scene::Scene other = with_mesh(scene, factor);
    const int elements = elements_of(*other.beam());
    if (std::ranges::find(seen, elements) != seen.end() || other.size() > kAffordableSize) continue;
    seen.push_back(elements);
    all.push_back({.name = fmt::format("{} elements", elements), .axis = Axis::kElements, .scene = other});
  }
  return all;
}

std::vector<Variant> of(Axis axis, std::vector<OtherContacts> others) {
  std::vector<Variant> all;
  all.reserve(others.size());
  for (OtherContacts& other : others) {
    all.push_back({.name = std::move(other.name), .axis = axis, .scene = std::move(other.scene)});
  }
  return all;
}

/// Those asked for that the basis has, or a few.
std::vector<Eigen::Index> sizes_of(const scene::Scene& scene, Eigen::Index size) {
  const std::vector<int>& asked = scene.drive.period() ? scene.driven.modes : scene.validation.modes;
  std::vector<Eigen::Index> sizes;
  for (const int L : asked) {
    if (L <= size) sizes.push_back(L);
  }
  return sizes.empty() ? thinned_sizes(size) : sizes;
}

std::string shown(scene::BasisChoice basis) {
  std::string word = scene::to_string(basis);
  const std::string tail = "+static";
  for (char& letter : word) letter = static_cast<char>(std::toupper(letter));
  if (basis == scene::BasisChoice::kLnmStatic) return "LNM" + tail;
  return basis == scene::BasisChoice::kMassPom ? "mass-POM" : word;
}

std::vector<Variant> reductions(const scene::Scene& scene, const std::vector<OfferedBasis>& bases) {
  std::vector<Variant> all;
  for (const OfferedBasis& offered : bases) {
    for (const Eigen::Index L : sizes_of(scene, offered.basis.modes())) {
      all.push_back({.name = fmt::format("{} {}", L, shown(offered.choice)),
                     .axis = Axis::kModes,
                     .scene = scene,
                     .reduction = Reduction{.basis = offered.choice, .modes = L}});
    }
  }
  return all;
}

}  // namespace

Variant as_it_stands(const scene::Scene& scene) {
  return {.name = "scene as it stands", .axis = Axis::kScene, .scene = scene};
}

Variant reference_of(const scene::Scene& scene) {
  Variant reference{.name = "reference", .axis = Axis::kScene, .scene = scene};
  std::string words = "all degrees of freedom";
  if (scene.beam() != nullptr) {
    const scene::Scene finer = with_mesh(scene, 2.0);
    if (finer.size() <= kAffordableSize) reference.scene = finer;
    words = fmt::format("{} elements", elements_of(*reference.scene.beam()));
  }
  const dynamics::HybridSystem system = scene::build_system(reference.scene);
  const bool closed = system.size() <= kAffordableSize && can_run_with(system, FlowMethod::kClosedForm);
  dynamics::FlowOptions& flow = reference.scene.flow;
  if (closed) {
    flow.method = FlowMethod::kClosedForm;
    words += ", closed form";
  } else {
    flow.tolerance = std::min(flow.tolerance, kReferenceTolerance);
    words += fmt::format(", tolerance {:.0e}", flow.tolerance);
  }
  reference.name = "reference: " + words;
  return reference;
}

std::vector<Eigen::Index> thinned_sizes(Eigen::Index size) {
  std::vector<Eigen::Index> sizes;
  if (size < 1) return sizes;
  const auto count = std::min(static_cast<std::size_t>(size), kMostSizes);
  for (std::size_t k = 1; k <= count; ++k) {
    const double place = std::pow(static_cast<double>(size), static_cast<double>(k) / static_cast<double>(count));
    const Eigen::Index L = count == static_cast<std::size_t>(size) ? static_cast<Eigen::Index>(k)
                                                                   : static_cast<Eigen::Index>(std::lround(place));
    if (sizes.empty() || L > sizes.back()) sizes.push_back(L);
  }
  return sizes;
}

std::vector<Axis> axes_of(const scene::Scene& scene) {
  std::vector<Axis> axes;
  if (scene.size() > 1) axes.push_back(Axis::kModes);
  for (const Axis axis : {Axis::kFlow, Axis::kTheory, Axis::kElements, Axis::kLaw, Axis::kLoad}) {
    if (!along(axis, scene, {}).empty()) axes.push_back(axis);
  }
  for (const Axis axis : {Axis::kHarmonics, Axis::kSamples, Axis::kMixed}) {
    if (!orbit_methods(axis, scene).empty()) axes.push_back(axis);
  }
  return axes;
}

std::vector<Axis> parse_axes(const std::string& words, const std::vector<Axis>& available) {
  std::string valid;
  for (const Axis axis : available) valid += (valid.empty() ? "" : ", ") + std::string(to_string(axis));
  std::vector<Axis> axes;
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(',', begin), words.size());
    const std::string word = words.substr(begin, end - begin);
    const auto found = std::ranges::find(available, word, [](Axis axis) { return std::string(to_string(axis)); });
    if (found == available.end()) {
      throw InvalidInput(fmt::format("--axes {}: this scene has no axis '{}'; valid: {}", words, word, valid));
    }
    if (std::ranges::find(axes, *found) == axes.end()) axes.push_back(*found);
    begin = end + 1;
  }
  return axes;
}

std::vector<Variant> along(Axis axis, const scene::Scene& scene, const std::vector<OfferedBasis>& bases) {
  switch (axis) {
    case Axis::kModes:
      return reductions(scene, bases);
    case Axis::kFlow:
      return flows(scene);
    case Axis::kTheory:
      return theories(scene);
    case Axis::kElements:
      return meshes(scene);
    case Axis::kLaw:
      return of(axis, other_laws(scene));
    case Axis::kLoad:
      return of(axis, other_loads(scene));
    case Axis::kScene:
    case Axis::kHarmonics:
    case Axis::kSamples:
    case Axis::kMixed:
    case Axis::kCombined:
    case Axis::kEffect:
    case Axis::kLean:
      break;
  }
  return {};
}

Variant combined(const Variant& reduced, const Variant& flow) {
  Variant both = reduced;
  both.name = fmt::format("{}, {}", reduced.name, flow.name);
  both.axis = Axis::kCombined;
  both.scene.flow = flow.scene.flow;
  return both;
}

std::vector<Variant> product(const std::vector<Variant>& variants) {
  std::vector<Variant> all;
  for (const Variant& reduced : variants) {
    if (reduced.axis != Axis::kModes) continue;
    for (const Variant& flow : variants) {
      if (flow.axis == Axis::kFlow) all.push_back(combined(reduced, flow));
    }
  }
  return all;
}

}  // namespace slipmode::trade
