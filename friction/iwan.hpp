#pragma once

#include <slipmode/core/fields.hpp>

#include <tuple>
#include <vector>

namespace slipmode::friction {

/// A joint in micro- and macroslip: Jenkins elements side by side whose slip displacements φ (limit force over
/// stiffness) have the density ρ(φ) = R φ^χ up to φ_max and an impulse S at φ_max. Its numbers are the force at which
/// the whole joint slides, F_S = ∫ φ ρ dφ, its stiffness when nothing slides, K_T = ∫ ρ dφ, and β = S over the rest of
/// K_T. Source: D. J. Segalman, A four-parameter Iwan model for lap-type joints, J. Appl. Mech. 72 (2005) 752; derived
/// in docs/theory/compliant-contacts.md, section 8.
struct Iwan {
  double slip_force = 0.0, stiffness = 0.0, chi = 0.0, beta = 0.0;
  int elements = 30;
  double finest = 0.01;

  static constexpr const char* word = "iwan";
  static constexpr auto fields() {
    return std::tuple{
        required("slip_force", &Iwan::slip_force, "N", "F_S, at which the whole joint slides", kPositive),
        required("stiffness", &Iwan::stiffness, "N/m", "K_T, of the joint when nothing slides", kPositive),
        required("chi", &Iwan::chi, "1", "exponent of the density; energy lost grows as amplitude^(chi + 3)",
                 {.low = -1.0, .above = true, .text = "a number > -1"}),
        required("beta", &Iwan::beta, "1", "stiffness that slides last over the rest", kNonNegative),
        optional("elements", &Iwan::elements, "", "of the density; with beta > 0 there is one more",
                 {.low = 1.0, .high = 1000.0}),
        optional("finest", &Iwan::finest, "1", "largest slip displacement of the first element, of phi_max",
                 {.low = 0.0, .high = 0.5, .above = true, .text = "a number > 0 and <= 0.5"})};
  }
};

/// A spring behind a slider: one share of a joint.
struct JenkinsElement {
  double stiffness = 0.0;   ///< [N/m]
  double slip_force = 0.0;  ///< [N]
};

/// φ_max, the slip displacement of what slides last [m].
[[nodiscard]] double largest_slip(const Iwan& law);

/// The joint as Jenkins elements, first to slide first. The density is divided at slip displacements whose ratio is the
/// same from `finest` φ_max to φ_max; an element has the stiffness and the limit force of its part, so that those of
/// the joint are kept exactly, and lost energy to second order in the logarithm of the ratio.
[[nodiscard]] std::vector<JenkinsElement> elements_of(const Iwan& law);

}  // namespace slipmode::friction
