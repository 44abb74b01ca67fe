#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/friction/characteristic.hpp>
#include <slipmode/friction/clearance.hpp>
#include <slipmode/friction/compliant.hpp>
#include <slipmode/friction/contact_forces.hpp>
#include <slipmode/friction/coulomb.hpp>
#include <slipmode/friction/dahl.hpp>
#include <slipmode/friction/lugre.hpp>
#include <slipmode/friction/measured.hpp>
#include <slipmode/friction/stribeck.hpp>
#include <slipmode/friction/tanh.hpp>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

namespace slipmode::friction {

/// Every law is a struct with its numbers that has a word and the fields of its numbers, for files, and answers what is
/// asked of it:
///
///     kind()                      what it is to whoever moves its contact
///     static_coefficient()        μ_s
///     limit_coefficient()         μ_k: what remains at large sliding speed
///     kinetic_coefficient(speed)  |λ|/N in steady slip
///     fastest_rate(pace)          how fast it can make its contact change [1/s]
///     forces(normal_load)         its numbers times the normal load, for the flows
///
/// Laws without a word, which files cannot hold, come last.
using Law = std::variant<Coulomb, Stribeck, TanhRegularised, CompliantCoulomb, Dahl, LuGre, Clearance, Measured,
                         Characteristic>;

/// The words of the laws that have one, in the order of Law's alternatives.
[[nodiscard]] std::vector<std::string> law_words();
/// The word of this one.
/// @throws InvalidInput  for a law that has none
[[nodiscard]] std::string law_word(const Law& law);

/// The normal load's own vibration: a mass on the beam's normal stiffness, pressed on the inclined slider by a leaf
/// spring that rides at height slope · y, y the contact's displacement:
///
///     m z̈ + (c_b + c_e) ż + (k_b + k_e) z = k_e s y + c_e s ẏ,     N = N0 + k_e (s y − z) + c_e (s ẏ − ż).
///
/// One-way: friction does not act back on z. Source: S4 (6.25), (6.26), measured from the static preload N0 = k_e Z_c;
/// as printed the preload enters twice.
struct NormalOscillator {
  double mass = 0.0, support_stiffness = 0.0, support_damping = 0.0, spring_stiffness = 0.0, spring_damping = 0.0,
         slope = 0.0;

  static constexpr auto fields() {
    using Own = NormalOscillator;
    return std::tuple{required("mass", &Own::mass, "kg", "m", kPositive),
                      required("support_stiffness", &Own::support_stiffness, "N/m", "k_b", kNonNegative),
                      optional("support_damping", &Own::support_damping, "N s/m", "c_b", kNonNegative),
                      required("spring_stiffness", &Own::spring_stiffness, "N/m", "k_e", kPositive),
                      optional("spring_damping", &Own::spring_damping, "N s/m", "c_e", kNonNegative),
                      required("slope", &Own::slope, "1", "s, rise of the slider along y")};
  }
};

/// The normal load: constant, affine in the contact's displacement y = wᵀq + offset, N = constant + slope y, or with a
/// normal oscillator (slope 0 then). Where it would be negative contact is lost: no force until it is positive again.
struct NormalLoad {
  double constant = 1.0, slope = 0.0;
  std::optional<NormalOscillator> oscillator = {};

  static constexpr auto fields() {
    return std::tuple{required("constant", &NormalLoad::constant, "N", "normal load, constant part", kPositive)
                          .stored_as("normal_load"),
                      optional("slope", &NormalLoad::slope, "N/m", "normal load per contact displacement")
                          .stored_as("normal_load_slope"),
                      optional("oscillator", &NormalLoad::oscillator, "", "its own vibration")};
  }

  NormalLoad() = default;
  NormalLoad(double n0) : constant(n0) {}  // NOLINT(google-explicit-constructor): a number is a constant load
  NormalLoad(double n0, double n1) : constant(n0), slope(n1) {}
  NormalLoad(double n0, NormalOscillator own) : constant(n0), oscillator(own) {}

  [[nodiscard]] bool is_constant() const { return slope == 0.0 && !oscillator; }
};

/// One contact: displacement wᵀq + offset, friction force λ along w on the structure. Relative velocity is
/// v_rel = v_drive − wᵀq̇, so a positive v_rel drags the structure along +w (S4 (3.4)).
struct Contact {
  Eigen::VectorXd direction;  ///< w [n]
  Law law;
  NormalLoad normal_load = {};
  double offset = 0.0;  ///< added to wᵀq: what an affine reduced basis leaves at q = q̄ [m]
  /// Angle between the slider's face and the direction of motion, |tilt| < π/2 [rad]. A coefficient μ then acts as
  /// (μ cos θ ± sin θ)/(cos θ ∓ μ sin θ) for a force along ±w. Coulomb laws only. Source: S4 (4.1), both directions.
  double tilt = 0.0;
  std::string name = {};

  static constexpr auto fields() {
    return std::tuple{optional("tilt", &Contact::tilt, "rad", "of the slider's face"),
                      required("offset", &Contact::offset, "m", "added to the contact displacement")};
  }
};

/// Checks a contact's numbers.
/// @throws InvalidInput  naming the contact, the value and the valid range: 0 ≤ μ_k ≤ μ_s, N0 ≥ 0, α ≥ 0, ε > 0,
///                       stiffnesses > 0, all finite, w not zero; tilt or a varying load with a law that is not
///                       Coulomb, rigid or compliant; a tilt at which an effective coefficient is negative or without
///                       bound; a clearance without stops, with a tilt, or whose stops overlap; a characteristic
///                       without its functions or with μ(0) > μ_s; points that are no table (fault_of)
void validate(const Contact& contact);

/// The coefficient that acts along ±w on a slider of this tilt. @param direction  +1 or −1
[[nodiscard]] double effective_coefficient(double mu, double tilt, double direction);

/// States a contact has of its own, in this order: stretch of the contact spring (compliant) or bristle deflection z
/// (Dahl, LuGre) [m]; displacement z and velocity ż of the normal oscillator [m], [m/s].
[[nodiscard]] int internal_states(const Contact& contact);

/// A contact's law times its normal load; of a load that varies, its constant part.
[[nodiscard]] ContactForces contact_forces(const Contact& contact);

/// What the law is; a load of zero is another matter (ContactForces).
[[nodiscard]] LawKind kind(const Law& law);
/// Force in steady slip at |v_rel| = speed ≥ 0, in units of the normal load (the friction coefficient), without tilt.
/// LuGre: without its viscous part, which does not scale with the load. 0 for a clearance.
[[nodiscard]] double kinetic_coefficient(const Law& law, double speed);
/// μ_k of any law (μ of Dahl's, μ(0) of a characteristic, 0 of a clearance): what remains at large sliding speed.
[[nodiscard]] double limit_coefficient(const Law& law);
/// μ_s of any law (μ of Dahl's, 0 of a clearance).
[[nodiscard]] double static_coefficient(const Law& law);
/// Stiffness of the contact spring or of the bristles; 0 for a law without [N/m].
[[nodiscard]] double spring_stiffness(const Law& law);
/// An estimate of how fast the law can make its contact change once it slides [1/s].
[[nodiscard]] double fastest_rate(const Law& law, const Pace& pace);
/// True when the force in slip does not depend on the sliding speed (Coulomb, rigid or compliant, or Stribeck with α =
/// 0 or μ_s = μ_k), and for a clearance: the contact is then piecewise linear.
[[nodiscard]] bool is_piecewise_linear(const Law& law);
/// True when the law treats both directions of motion alike.
[[nodiscard]] bool is_symmetric(const Law& law);
/// The law if it is a clearance, else null.
[[nodiscard]] inline const Clearance* clearance(const Law& law) { return std::get_if<Clearance>(&law); }

}  // namespace slipmode::friction
