#pragma once

#include <slipmode/friction/contact.hpp>

#include <optional>

namespace slipmode::friction {

// A law with one of its effects left out or put in; nothing where that changes nothing or has no meaning.

/// Without contact spring, bristles or regularisation: Coulomb or Stribeck.
[[nodiscard]] std::optional<Law> rigid(const Law& law);
/// The smooth stand-in. A static peak, where the law has a jump, decays over ten ε. @param epsilon  > 0 [m/s]
[[nodiscard]] std::optional<Law> regularised(const Law& law, double epsilon);
/// Behind a contact spring: its own, times the factor, or the one given to a rigid Coulomb law, times the factor.
/// @param stiffness  given to a law without a spring [N/m]; nothing where it is not > 0
[[nodiscard]] std::optional<Law> with_spring(const Law& law, double stiffness, double factor);
/// μ_s = μ_k.
[[nodiscard]] std::optional<Law> without_static_peak(const Law& law);
/// Stribeck's law as Coulomb's with the same coefficients.
[[nodiscard]] std::optional<Law> without_stribeck_slope(const Law& law);
/// A clearance whose stops do not damp.
[[nodiscard]] std::optional<Law> without_stop_damping(const Law& law);

/// The law with its limit, or its stops' forces, in this share; as it is where it has neither as a number of its own.
[[nodiscard]] Law weakened(Law law, double share);

}  // namespace slipmode::friction
