#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/fem/structure.hpp>

#include <tuple>
#include <variant>
#include <vector>

namespace slipmode::fem {

enum class BeamTheory {
  kEulerBernoulli,  ///< Hermite elements: no shear, no rotary inertia
  kTimoshenko,      ///< elements exact in shear for end loads (no locking), with rotary inertia
};

/// A stretch of beam with one rectangular section and one material. SI units.
struct BeamSpan {
  double length = 0.0, width = 0.0, thickness = 0.0, youngs_modulus = 0.0, density = 0.0;
  int elements = 10;
  double poisson_ratio = 0.3;
  double shear_coefficient = 0.8497;  ///< Cowper's for a rectangle at ν = 0.3, 10(1+ν)/(12+11ν)

  static constexpr auto fields() {
    using Own = BeamSpan;
    return std::tuple{
        required("length", &Own::length, "m", "length", kPositive),
        required("width", &Own::width, "m", "width", kPositive),
        required("thickness", &Own::thickness, "m", "in the direction of motion", kPositive),
        required("youngs_modulus", &Own::youngs_modulus, "Pa", "Young's modulus", kPositive),
        required("density", &Own::density, "kg/m^3", "density", kPositive),
        required("elements", &Own::elements, "", "number of elements", {.low = 1.0, .high = 1e6}),
        optional("poisson_ratio", &Own::poisson_ratio, "1", "Timoshenko only: ν in G = E / (2 (1 + ν))",
                 {.low = -1.0, .high = 0.5, .above = true, .text = "a number > -1 and <= 0.5"}),
        optional("shear_coefficient", &Own::shear_coefficient, "1", "Timoshenko only: κ in κ G A", kPositive)};
  }
};

/// A rigid body on the free end.
struct TipBody {
  double mass = 0.0, inertia = 0.0, offset = 0.0, extension = 0.0;

  static constexpr auto fields() {
    return std::tuple{
        optional("mass", &TipBody::mass, "kg", "mass", kNonNegative),
        optional("inertia", &TipBody::inertia, "kg m^2", "about its own centre of mass", kNonNegative),
        optional("offset", &TipBody::offset, "m", "of its centre of mass beyond the beam's end, along the beam"),
        optional("extension", &TipBody::extension, "m", "rigid, from the beam's end to the contact", kNonNegative)};
  }
};

/// A damping ratio wanted at a frequency.
struct RatioAt {
  double ratio = 0.0;         ///< ≥ 0
  double frequency_hz = 0.0;  ///< > 0
};

/// C = cK with the ratio met at one frequency, or C = aM + bK with ratios met at two.
struct ProportionalRatios {
  std::vector<RatioAt> at;  ///< one or two
};

/// Each natural mode of the beam with its tip body, no contact, has its own ratio: C = M Φ diag(2 ζ_i ω_i) Φᵀ M.
struct ModalRatios {
  std::vector<double> ratios;

  static constexpr auto fields() {
    return std::tuple{required("modal_ratio", &ModalRatios::ratios, "1",
                               "of modes 1, 2, ..., one or more; the last one holds for all further modes",
                               kNonNegative)
                          .per_item()};
  }
};

using BeamDamping = std::variant<Rayleigh, ProportionalRatios, ModalRatios>;

struct BeamOptions {
  BeamTheory theory = BeamTheory::kEulerBernoulli;
  std::vector<BeamSpan> spans;  ///< from the clamp to the free end, at least one
  TipBody tip;
  BeamDamping damping = Rayleigh{};

  static constexpr auto fields() { return std::tuple{optional("theory", &BeamOptions::theory, "", "of bending")}; }
};

}  // namespace slipmode::fem
