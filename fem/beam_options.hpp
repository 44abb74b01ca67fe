#pragma once

#include <slipmode/fem/structure.hpp>

#include <variant>
#include <vector>

namespace slipmode::fem {

enum class BeamTheory {
  kEulerBernoulli,  ///< Hermite elements: no shear, no rotary inertia
  kTimoshenko,      ///< elements exact in shear for end loads (no locking), with rotary inertia
};

/// A stretch of beam with one rectangular section and one material. SI units.
struct BeamSpan {
  double length = 0.0;          ///< > 0 [m]
  double width = 0.0;           ///< > 0 [m]
  double thickness = 0.0;       ///< in the direction of motion, > 0 [m]
  double youngs_modulus = 0.0;  ///< > 0 [Pa]
  double density = 0.0;         ///< > 0 [kg/m³]
  int elements = 10;            ///< ≥ 1
  /// Timoshenko only: G = E / (2 (1 + ν)), −1 < ν ≤ 0.5.
  double poisson_ratio = 0.3;
  /// Timoshenko only: κ in κ G A, > 0. Default: Cowper's for a rectangle at ν = 0.3, 10(1+ν)/(12+11ν).
  double shear_coefficient = 0.8497;
};

/// A rigid body on the free end.
struct TipBody {
  double mass = 0.0;       ///< ≥ 0 [kg]
  double inertia = 0.0;    ///< about its own centre of mass, ≥ 0 [kg m²]
  double offset = 0.0;     ///< of its centre of mass beyond the beam's end, along the beam [m]
  double extension = 0.0;  ///< rigid, from the beam's end to the contact, ≥ 0 [m]
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
  std::vector<double> ratios;  ///< of modes 1, 2, …; the last one holds for all further modes; not empty, each ≥ 0
};

using BeamDamping = std::variant<Rayleigh, ProportionalRatios, ModalRatios>;

struct BeamOptions {
  BeamTheory theory = BeamTheory::kEulerBernoulli;
  std::vector<BeamSpan> spans;  ///< from the clamp to the free end, at least one
  TipBody tip;
  BeamDamping damping = Rayleigh{};
};

}  // namespace slipmode::fem
