#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace slipmode::friction {

/// Rigid Coulomb friction. In slip λ = μ_k N sign(v_rel); in stick |λ| ≤ μ_s N.
struct Coulomb {
  double mu_s = 0.0;  ///< ≥ mu_k
  double mu_k = 0.0;  ///< ≥ 0
};

/// Rigid friction with an exponential Stribeck curve. In slip λ = N (μ_k + (μ_s − μ_k) e^{−α|v_rel|}) sign(v_rel); in
/// stick |λ| ≤ μ_s N. Source: S4 (3.4)-(3.6).
struct Stribeck {
  double mu_s = 0.0;   ///< ≥ mu_k
  double mu_k = 0.0;   ///< ≥ 0
  double alpha = 0.0;  ///< decay with sliding speed, ≥ 0 [s/m]
};

/// The smooth stand-in everybody uses: λ = N (μ_k + (μ_s − μ_k) e^{−α |v|}) tanh(v/ε) with |v| ≈ v tanh(v/ε), so that
/// λ is analytic. There is no stick, only creep; the error is of the order of ε. Kept as a baseline to measure against.
struct TanhRegularised {
  double mu_s = 0.0;
  double mu_k = 0.0;
  double alpha = 0.0;     ///< [s/m]
  double epsilon = 1e-3;  ///< > 0 [m/s]
};

/// Coulomb friction behind a tangential contact spring (Jenkins element, elastic Coulomb). In stick
/// λ = K_c (y_c − y) with y_c the contact point, carried by the drive; in slip λ = μ_k N sign of the sliding speed. The
/// stretch y_c − y is kept when sliding ends; when it begins at |λ| = μ_s N > μ_k N the massless contact point jumps.
/// Source: S4 section 6.1.2 and (6.23), with the sign of K_c corrected.
struct CompliantCoulomb {
  double mu_s = 0.0;       ///< ≥ mu_k
  double mu_k = 0.0;       ///< ≥ 0
  double stiffness = 0.0;  ///< K_c > 0 [N/m]
};

/// Dahl's law: λ = σ z, ż = v_rel − |v_rel| σ z / (μ N): a spring that yields smoothly; no difference between static
/// and kinetic friction. Source: P. R. Dahl, A solid friction model, TOR-158(3107-18), Aerospace Corporation, 1968,
/// with exponent 1.
struct Dahl {
  double mu = 0.0;         ///< > 0
  double stiffness = 0.0;  ///< σ > 0 [N/m]
};

/// The LuGre bristle law: λ = σ0 z + σ1 ż + σ2 v_rel, ż = v_rel − σ0 |v_rel| z / g(v_rel),
/// g(v) = N (μ_k + (μ_s − μ_k) e^{−(v/v_s)²}).
/// Source: Canudas de Wit, Olsson, Åström, Lischinsky, IEEE Trans. Automatic Control 40 (1995) 419.
struct LuGre {
  double mu_s = 0.0;            ///< ≥ mu_k
  double mu_k = 0.0;            ///< > 0
  double stribeck_speed = 0.0;  ///< v_s > 0 [m/s]
  double stiffness = 0.0;       ///< σ0 > 0 [N/m]
  double damping = 0.0;         ///< σ1 ≥ 0 [N s/m]
  double viscous = 0.0;         ///< σ2 ≥ 0 [N s/m]
};

/// One stop of a clearance: beyond the gap it presses with stiffness · (|y| − gap) + damping · d|y|/dt.
struct Stop {
  double stiffness = 0.0;  ///< k > 0 [N/m]
  double damping = 0.0;    ///< c ≥ 0 [N s/m]
  double gap = 0.0;  ///< b [m]: contact at y ≥ b on the right, y ≤ −b on the left; may be negative (preload)
};

/// When a stop lets go.
enum class ContactLoss : std::uint8_t {
  /// Where its force falls to zero: it never pulls. S0. Until y is back at the gap the stop is free and engages again,
  /// without a jump, when k (|y| − b) + c d|y|/dt is positive again.
  kZeroForce,
  /// At the gap, S1 and S2; with damping it pulls on the way out.
  kGap,
};

/// Play between stops (clearance, backlash): no force in the gap, −k (y − b) − c ẏ at the right stop, the mirror image
/// at the left one. A stop that is absent is never met. It has no friction, and the normal load is not read. Source: S0
/// (2.4)-(2.7), S1 (1), S2 (1).
struct Clearance {
  std::optional<Stop> left, right;  ///< at least one
  ContactLoss loss = ContactLoss::kZeroForce;
};

using Law = std::variant<Coulomb, Stribeck, TanhRegularised, CompliantCoulomb, Dahl, LuGre, Clearance>;

/// The normal load's own vibration: a mass on the beam's normal stiffness, pressed on the inclined slider by a leaf
/// spring that rides at height slope · y, y the contact's displacement:
///
///     m z̈ + (c_b + c_e) ż + (k_b + k_e) z = k_e s y + c_e s ẏ,     N = N0 + k_e (s y − z) + c_e (s ẏ − ż).
///
/// One-way: friction does not act back on z. Source: S4 (6.25), (6.26), measured from the static preload N0 = k_e Z_c;
/// as printed the preload enters twice.
struct NormalOscillator {
  double mass = 0.0;               ///< m > 0 [kg]
  double support_stiffness = 0.0;  ///< k_b ≥ 0 [N/m]
  double support_damping = 0.0;    ///< c_b ≥ 0 [N s/m]
  double spring_stiffness = 0.0;   ///< k_e ≥ 0 [N/m]
  double spring_damping = 0.0;     ///< c_e ≥ 0 [N s/m]
  double slope = 0.0;              ///< s, rise of the slider along y
};

/// The normal load: constant, affine in the contact's displacement y = wᵀq + offset, N = constant + slope y, or with a
/// normal oscillator (slope 0 then). Where it would be negative contact is lost: no force until it is positive again.
struct NormalLoad {
  double constant = 1.0;  ///< N0 ≥ 0 [N]
  double slope = 0.0;     ///< N1 [N/m]
  std::optional<NormalOscillator> oscillator = {};

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
};

/// Checks a contact's numbers.
/// @throws InvalidInput  naming the contact, the value and the valid range: 0 ≤ μ_k ≤ μ_s, N0 ≥ 0, α ≥ 0, ε > 0,
///                       stiffnesses > 0, all finite, w not zero; tilt or a varying load with a law that is not
///                       Coulomb, rigid or compliant; a tilt at which an effective coefficient is negative or without
///                       bound; a clearance without stops, with a tilt, or whose stops overlap
void validate(const Contact& contact);

/// The coefficient that acts along ±w on a slider of this tilt. @param direction  +1 or −1
[[nodiscard]] double effective_coefficient(double mu, double tilt, double direction);

/// States a contact has of its own, in this order: stretch of the contact spring (compliant) or bristle deflection z
/// (Dahl, LuGre) [m]; displacement z and velocity ż of the normal oscillator [m], [m/s].
[[nodiscard]] int internal_states(const Contact& contact);

/// Force in steady slip at |v_rel| = speed ≥ 0, in units of the normal load (the friction coefficient), without tilt.
/// LuGre: without its viscous part, which does not scale with the load. 0 for a clearance. Not for tanh.
[[nodiscard]] double kinetic_coefficient(const Law& law, double speed);
/// μ_k of any law (μ of Dahl's, 0 of a clearance): what remains at large sliding speed.
[[nodiscard]] double limit_coefficient(const Law& law);
/// μ_s of any law (μ of Dahl's, 0 of a clearance).
[[nodiscard]] double static_coefficient(const Law& law);
/// True when the force in slip does not depend on the sliding speed (Coulomb, rigid or compliant, or Stribeck with α =
/// 0 or μ_s = μ_k), and for a clearance: the contact is then piecewise linear.
[[nodiscard]] bool is_piecewise_linear(const Law& law);

}  // namespace slipmode::friction
