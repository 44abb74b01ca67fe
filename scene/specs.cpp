#include <slipmode/scene/specs.hpp>

#include <slipmode/diagnostics/attractors/sweep.hpp>
#include "scene/internal/scene_words.hpp"

#include <fmt/format.h>

namespace slipmode::scene {

std::string to_string(const ContactPlace& place) {
  if (const int* mass = std::get_if<int>(&place)) return fmt::format("{}", *mass);
  if (const double* x = std::get_if<double>(&place)) return fmt::format("{}", *x);
  if (const auto* pair = std::get_if<Between>(&place)) return fmt::format("{}-{}", pair->first, pair->second);
  return "tip";
}

std::string to_string(BasisChoice basis) { return word_of(basis); }

std::vector<double> Range::values() const { return diagnostics::sweep_values(from, to, step); }

}  // namespace slipmode::scene
