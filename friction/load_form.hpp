#pragma once

#include <slipmode/friction/contact.hpp>

#include <Eigen/Core>
#include <cmath>

namespace slipmode::friction {

/// A contact's normal load as a linear function of its own motion,
/// N = constant + y wᵀq + v wᵀq̇ + z ζ + z_rate ζ̇, with ζ the displacement of its normal oscillator, if it has one:
/// ζ̈ = −stiffness ζ − damping ζ̇ + lift (wᵀq + offset) + lift_rate wᵀq̇.
struct LoadForm {
  explicit LoadForm(const Contact& contact)
      : constant(contact.normal_load.constant), y(contact.normal_load.slope), offset(contact.offset) {
    if (const auto& own = contact.normal_load.oscillator) {
      mass = own->mass;
      y = own->spring_stiffness * own->slope;
      v = own->spring_damping * own->slope;
      z = -own->spring_stiffness;
      z_rate = -own->spring_damping;
      stiffness = (own->support_stiffness + own->spring_stiffness) / own->mass;
      damping = (own->support_damping + own->spring_damping) / own->mass;
      lift = y / own->mass;
      lift_rate = v / own->mass;
    }
    constant += y * offset;
  }

  [[nodiscard]] bool varies() const { return y != 0.0 || v != 0.0 || z != 0.0 || z_rate != 0.0; }
  [[nodiscard]] bool oscillates() const { return stiffness > 0.0; }
  /// N. @param displacement, velocity  wᵀq and wᵀq̇;  @param own  ζ, ζ̇; null without an oscillator
  [[nodiscard]] double load(double displacement, double velocity, const double* own) const {
    double N = constant + y * displacement + v * velocity;
    if (own != nullptr) N += z * own[0] + z_rate * own[1];
    return N;
  }

  /// What its terms add up to in size: N rounds by that. @param displacement, velocity  sizes
  [[nodiscard]] double size(double displacement, double velocity, const double* own) const {
    double sum = std::abs(constant) + std::abs(y) * displacement + std::abs(v) * velocity;
    if (own != nullptr) sum += std::abs(z * own[0]) + std::abs(z_rate * own[1]);
    return sum;
  }

  double constant = 0.0, y = 0.0, v = 0.0, z = 0.0, z_rate = 0.0;
  double mass = 0.0, stiffness = 0.0, damping = 0.0, lift = 0.0, lift_rate = 0.0;
  double offset = 0.0;
};

}  // namespace slipmode::friction
