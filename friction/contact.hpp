#pragma once

#include <slipmode/core/fields.hpp>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

namespace slipmode::friction {

/// The fields of a law with a static and a kinetic coefficient, mu_s ≥ mu_k.
template <class Law>
constexpr auto coefficients(const Limits& kinetic = kNonNegative) {
  return std::tuple{required("mu_s", &Law::mu_s, "1", "static coefficient", kNonNegative),
                    required("mu_k", &Law::mu_k, "1", "kinetic coefficient", kinetic)};
}

/// Rigid Coulomb friction. In slip λ = μ_k N sign(v_rel); in stick |λ| ≤ μ_s N.
struct Coulomb {
  double mu_s = 0.0, mu_k = 0.0;

  static constexpr const char* word = "coulomb";
  static constexpr auto fields() { return coefficients<Coulomb>(); }
};

/// Rigid friction with an exponential Stribeck curve. In slip λ = N (μ_k + (μ_s − μ_k) e^{−α|v_rel|}) sign(v_rel); in
/// stick |λ| ≤ μ_s N. Source: S4 (3.4)-(3.6).
struct Stribeck {
  double mu_s = 0.0, mu_k = 0.0, alpha = 0.0;

  static constexpr const char* word = "stribeck";
  static constexpr auto fields() {
    return std::tuple_cat(coefficients<Stribeck>(), std::tuple{required("alpha", &Stribeck::alpha, "s/m",
                                                                        "decay with sliding speed", kNonNegative)});
  }
};

/// The smooth stand-in everybody uses: λ = N (μ_k + (μ_s − μ_k) e^{−α |v|}) tanh(v/ε) with |v| ≈ v tanh(v/ε), so that
/// λ is analytic. There is no stick, only creep; the error is of the order of ε. Kept as a baseline to measure against.
struct TanhRegularised {
  double mu_s = 0.0, mu_k = 0.0, alpha = 0.0, epsilon = 1e-3;

  static constexpr const char* word = "tanh";
  static constexpr auto fields() {
    return std::tuple_cat(
        coefficients<TanhRegularised>(),
        std::tuple{optional("alpha", &TanhRegularised::alpha, "s/m", "decay with sliding speed", kNonNegative),
                   optional("epsilon", &TanhRegularised::epsilon, "m/s", "regularisation speed", kPositive)});
  }
};

/// Coulomb friction behind a tangential contact spring K_c (Jenkins element, elastic Coulomb). In stick
/// λ = K_c (y_c − y) with y_c the contact point, carried by the drive; in slip λ = μ_k N sign of the sliding speed. The
/// stretch y_c − y is kept when sliding ends; when it begins at |λ| = μ_s N > μ_k N the massless contact point jumps.
/// Source: S4 section 6.1.2 and (6.23), with the sign of K_c corrected.
struct CompliantCoulomb {
  double mu_s = 0.0, mu_k = 0.0, stiffness = 0.0;

  static constexpr const char* word = "compliant";
  static constexpr auto fields() {
    return std::tuple_cat(coefficients<CompliantCoulomb>(),
                          std::tuple{required("stiffness", &CompliantCoulomb::stiffness, "N/m",
                                              "of contact spring or bristle", kPositive)});
  }
};

/// Dahl's law: λ = σ z, ż = v_rel − |v_rel| σ z / (μ N): a spring σ that yields smoothly; no difference between static
/// and kinetic friction. Source: P. R. Dahl, A solid friction model, TOR-158(3107-18), Aerospace Corporation, 1968,
/// with exponent 1.
struct Dahl {
  double mu = 0.0, stiffness = 0.0;

  static constexpr const char* word = "dahl";
  static constexpr auto fields() {
    return std::tuple{required("mu", &Dahl::mu, "1", "coefficient", kPositive).stored_as("mu_s"),
                      required("stiffness", &Dahl::stiffness, "N/m", "of contact spring or bristle", kPositive)};
  }
};

/// The LuGre bristle law: λ = σ0 z + σ1 ż + σ2 v_rel, ż = v_rel − σ0 |v_rel| z / g(v_rel),
/// g(v) = N (μ_k + (μ_s − μ_k) e^{−(v/v_s)²}), with stiffness σ0, damping σ1, viscous σ2, stribeck_speed v_s.
/// Source: Canudas de Wit, Olsson, Åström, Lischinsky, IEEE Trans. Automatic Control 40 (1995) 419.
struct LuGre {
  double mu_s = 0.0, mu_k = 0.0, stribeck_speed = 0.0, stiffness = 0.0, damping = 0.0, viscous = 0.0;

  static constexpr const char* word = "lugre";
  static constexpr auto fields() {
    return std::tuple_cat(
        coefficients<LuGre>(kPositive),
        std::tuple{
            required("stribeck_speed", &LuGre::stribeck_speed, "m/s", "Stribeck speed", kPositive),
            required("stiffness", &LuGre::stiffness, "N/m", "of contact spring or bristle", kPositive),
            optional("damping", &LuGre::damping, "N s/m", "of the bristle", kNonNegative).stored_as("bristle_damping"),
            optional("viscous", &LuGre::viscous, "N s/m", "viscous friction", kNonNegative)});
  }
};

/// One stop of a clearance: beyond the gap it presses with stiffness · (|y| − gap) + damping · d|y|/dt. Contact is at
/// y ≥ gap on the right, y ≤ −gap on the left; a negative gap is a preload.
struct Stop {
  double stiffness = 0.0, damping = 0.0, gap = 0.0;

  static constexpr auto fields() {
    return std::tuple{required("stiffness", &Stop::stiffness, "N/m", "stiffness", kPositive),
                      optional("damping", &Stop::damping, "N s/m", "damping", kNonNegative),
                      required("gap", &Stop::gap, "m", "gap")};
  }
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

  static constexpr const char* word = "clearance";
  static constexpr auto fields() {
    return std::tuple{optional("loss", &Clearance::loss, "", "when a stop lets go"),
                      optional("left", &Clearance::left, "", "left stop"),
                      optional("right", &Clearance::right, "", "right stop")};
  }
};

using Law = std::variant<Coulomb, Stribeck, TanhRegularised, CompliantCoulomb, Dahl, LuGre, Clearance>;

/// The words of the laws, in the order of Law's alternatives.
[[nodiscard]] inline std::vector<std::string> law_words() { return words_of(Law()); }

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

namespace slipmode {

template <>
inline constexpr std::array kWords<friction::ContactLoss> = {"zero-force", "gap"};

}  // namespace slipmode
