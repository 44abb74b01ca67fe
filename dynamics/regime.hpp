#pragma once

#include <slipmode/dynamics/contact_role.hpp>
#include <slipmode/dynamics/lazy_levels.hpp>
#include <slipmode/dynamics/modal_model.hpp>
#include <slipmode/dynamics/nodes.hpp>
#include <slipmode/dynamics/pair_motion.hpp>

#include <Eigen/Core>
#include <array>
#include <vector>

namespace slipmode::dynamics {

/// A scalar of a regime that must keep its sign: what guards are made of.
struct RegimeOutput {
  enum class Kind : std::uint8_t {
    kSpeed,         ///< sliding speed; of the contact point, behind a contact spring
    kForce,         ///< λ in stick
    kExcess,        ///< μ_s N − λ, what is left to the upper limit under a load that varies
    kReserve,       ///< μ_s N + λ, what is left to the lower one
    kLoad,          ///< N
    kDisplacement,  ///< y = wᵀq + offset, of a clearance
    kPress,         ///< k (|y| − b) + c d|y|/dt: what a stop presses with, or would
  };
  int contact = 0;
  Kind kind = Kind::kSpeed;
};

/// The structure with its contacts in certain roles, as decoupled pairs driven by inputs that are polynomials of time
/// (a harmonic drive is laid over them, see DriveOverlay):
///
///     ẋ = G x + B ι,   ι = (ι_1 … ι_nc, V, a, 1, u_1 … u_nk).
///
/// ι_c follows the drive (ι̇_c = V, V̇ = a) where the contact sticks: held, it is wᵀq; sprung, the contact point less
/// its offset. Else it is constant: the constant part of λ_c. u_k are the forces of a force drive, laid over as well.
///
/// Held directions are eliminated in the undamped modes of the slipping structure with an orthonormal null-space basis;
/// contact springs, stops and loads that vary with y add rank-one stiffness and damping, normal oscillators their own
/// states.
/// Source: docs/theory/flow.md.
struct Regime {
  Regime(const HybridSystem& system, const ModalModel& slipping, const std::vector<ContactRole>& roles);

  [[nodiscard]] Eigen::Index inputs() const { return speed_input() + 3 + forces; }
  [[nodiscard]] Eigen::Index speed_input() const { return static_cast<Eigen::Index>(roles.size()); }
  /// Of the force drive's direction k.
  [[nodiscard]] Eigen::Index force_input(Eigen::Index k) const { return speed_input() + 3 + k; }
  [[nodiscard]] bool held(int c) const { return roles[static_cast<std::size_t>(c)] == ContactRole::kHeld; }
  [[nodiscard]] bool sticks(int c) const { return follows[static_cast<std::size_t>(c)]; }
  /// ι after a time t.
  void advance_inputs(Eigen::VectorXd& inputs, double t) const;
  /// State of the slipping model: to_slipping x + inputs_slipping ι.
  void lift(const Eigen::VectorXd& x, const Eigen::VectorXd& inputs, Eigen::VectorXd& out_slipping) const;
  /// Value of output k.
  [[nodiscard]] double output(Eigen::Index k, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) const;
  /// λ of a contact on x_p. Ways, each with a spring's stiffness, count by what they differ from its own.
  [[nodiscard]] double held_force(Eigen::Index contact, const Eigen::VectorXd& inputs) const;
  /// Time derivative of (row, coefficients): again of that form.
  void differentiate(Eigen::VectorXd& row, Eigen::VectorXd& coefficient) const;
  /// q̇ᵀCq̇ of a state [W].
  [[nodiscard]] double viscous_power(const Eigen::VectorXd& x, double drive_velocity) const;

  std::vector<ContactRole> roles;
  Eigen::Index forces = 0;    ///< directions of a force drive
  std::vector<bool> follows;  ///< held or sprung
  std::vector<RegimeOutput> outputs;
  ModalModel pairs;                ///< only its pairs are used: no contacts
  bool told_from_rounding = true;  ///< no pair is so slow that its frequency may be rounding of zero
  PairMotion motion;               ///< free motion of those that oscillate
  double rate = 0.0;    ///< fastest rate of the pairs, or of the slipping structure if nothing is left to move [1/s]
  double growth = 0.0;  ///< largest rate at which free motion grows, 0 if none does [1/s]
  Eigen::MatrixXd B;    ///< [2np x ni]; the drive's columns act through ι as described above
  Eigen::VectorXd B_follows;    ///< Σ over contacts that follow the drive of their columns of B
  Eigen::MatrixXd forcing;      ///< B with B_follows beside it [2np x (ni+1)]
  Eigen::MatrixXd row;          ///< outputs, columns [2np x no]
  Eigen::MatrixXd coefficient;  ///< outputs' dependence on ι, columns [ni x no]
  Eigen::MatrixXd row1, row2;   ///< first and second derivatives of the outputs
  Eigen::MatrixXd coefficient1, coefficient2;
  /// λ, wᵀq̇ and wᵀq of each contact [2np x nc], [ni x nc].
  Eigen::MatrixXd force_row, force_coefficient, velocity_row, velocity_coefficient;
  Eigen::MatrixXd displacement_row, displacement_coefficient;
  /// What adds up to wᵀq and wᵀq̇, see ModalModel::place_row: of sizes |x| and |ι| [2np x 2nc], [ni x 2nc].
  Eigen::MatrixXd place_row, place_coefficient;
  Eigen::MatrixXd steady_force;                  ///< λ of each contact on x_p [ni x nc]
  Eigen::VectorXd steady_together;               ///< that of the ways of all contacts that follow at once [nc]
  Eigen::MatrixXd beside_rows;                   ///< what that is beside what the rows make of x_p [ni x nc]
  Eigen::MatrixXd drive_row, drive_coefficient;  ///< d_kᵀq̇ of each force direction [2np x nk], [ni x nk]
  Eigen::VectorXd spring;                        ///< K_c of sprung contacts, else 0 [nc]
  std::vector<ContactAnswer> answers;            ///< of each contact [nc]
  Eigen::VectorXd slope;  ///< dλ/d(wᵀq) of contacts that slide under a load that depends on wᵀq alone, else 0 [nc]

  Eigen::MatrixXd from_slipping;    ///< state of the slipping model → x [2np x 2np_s]
  Eigen::MatrixXd to_slipping;      ///< x → state of the slipping model [2np_s x 2np]
  Eigen::MatrixXd inputs_slipping;  ///< ι → its part there [2np_s x ni]
  /// Where the slipping model's states are displacements and their rates, the displacements' rows of `to_slipping`: the
  /// rates are these rows of Gx. Else empty [np_s x 2np].
  Eigen::MatrixXd to_displacements;
  Eigen::MatrixXd from_oscillators;  ///< (ζ, ζ̇ contact after contact) → x [2np x 2k]; no columns without oscillators
  Eigen::MatrixXd to_oscillators;  ///< x → them [2k x 2np]

  /// For bounds. Each pair is scaled so that its free motion never grows (faster than `growth`) in the Euclidean norm
  /// (energy norm for modal pairs) and its generator has norm `pair_rate`; `particular` is the motion that follows the
  /// inputs. Components that are plain polynomials of time have scale 0: interpolation is exact for them.
  Eigen::VectorXd scale1, scale2;            ///< [np]
  Eigen::VectorXd pair_rate;                 ///< ‖G_i‖ in that scale [np]
  Eigen::MatrixXd particular;                ///< ι → x_p [2np x ni]
  Eigen::MatrixXd weight;                    ///< ‖row_i‖ in that scale [np x no]
  Eigen::MatrixXd weight2, weight3;          ///< times pair_rate squared, cubed
  Eigen::MatrixXd polynomial2, polynomial3;  ///< ι → second and third derivative of what is polynomial [ni x no]
  Eigen::VectorXd viscous_cross;             ///< q̇ᵀCq̇ = pairs' + 2V (this·x) + V² viscous_drive [2np]
  double viscous_drive = 0.0;

 private:
  void prepare_bounds();
  void prepare_lift(const ModalModel& slipping);
};

/// What a time h does: x(h) = e^{Gh} x + response ι.
struct RegimeStep {
  double h = 0.0;
  Eigen::VectorXd e11, e12, e21, e22;
  Eigen::MatrixXd response;  ///< [2np x ni]
};

/// What a time h changes of the free motion, e^{Gh} − I, where the regime has that in closed form.
struct RegimeChange {
  Eigen::VectorXd d11, d12, d21, d22;  ///< [np]
};

/// Outputs over a window of length h as polynomials of degree 7 in Bernstein form, with what interpolation leaves out.
struct RegimeWindow {
  Eigen::MatrixXd from_state;   ///< [8 x 2np no]
  Eigen::MatrixXd from_inputs;  ///< [8 x ni no]
  Eigen::MatrixXd remainder;    ///< |output − polynomial| ≤ this column · pair amplitudes [np x no]
};

/// States at the points of a quadrature rule, for the energy audit.
struct RegimeAudit {
  GaussRule rule;
  std::vector<RegimeStep> point;
};

/// Integrals of squares of a regime's free motion, whatever drives it: ∫ x_fᵀQ x_f dt = [x_fᵀY x_f] (see AuditForms).
struct RegimeForms {
  bool found = false;
  /// Lower triangles of Y of the contacts' work and of the viscous loss, off-diagonal entries doubled, zeros above
  /// [2np x 2np]; empty: no quadratic part.
  Eigen::MatrixXd contact, viscous;
  /// `viscous` is minus the energy of free motion, which n squares give in the modes of the slipping structure.
  bool viscous_is_energy = false;
};

/// A regime and its tables for windows of length top·2^{-level}, built when first used; safe to share between threads.
class RegimeTables {
 public:
  static constexpr int kLevels = 112;
  /// The first level at which the energy audit's rules are short enough to be tabulated.
  static constexpr int kAuditLevel = 28;

  RegimeTables(const HybridSystem& system, const ModalModel& slipping, const std::vector<ContactRole>& roles);

  [[nodiscard]] const Regime& regime() const { return regime_; }
  [[nodiscard]] double length(int level) const { return length_[static_cast<std::size_t>(level)]; }
  /// The finest level whose window is at least this long.
  [[nodiscard]] int level_covering(double length) const;
  [[nodiscard]] const RegimeStep& step(int level) const {
    return steps_.get(level, [&](RegimeStep& out) { make(out, level); });
  }
  [[nodiscard]] const RegimeWindow& window(int level) const {
    return windows_.get(level, [&](RegimeWindow& out) { make(out, level); });
  }
  [[nodiscard]] const RegimeChange& change(int level) const {
    return changes_.get(level, [&](RegimeChange& out) { make(out, level); });
  }
  /// @param make  make(regime, RegimeForms&) fills them when they are first asked for
  template <class Make>
  [[nodiscard]] const RegimeForms& forms(Make make) const {
    return forms_.get(0, [&](RegimeForms& out) { make(regime_, out); });
  }
  [[nodiscard]] const RegimeAudit& audit(int level) const {
    return audits_.get(level, [&](RegimeAudit& out) { make(out, level); });
  }

 private:
  void make(RegimeStep& out, int level) const;
  void make(RegimeWindow& out, int level) const;
  void make(RegimeChange& out, int level) const;
  void make(RegimeAudit& out, int level) const;
  void step_of(double h, RegimeStep& out) const;

  Regime regime_;
  std::array<double, kLevels> length_{};
  LazyLevels<RegimeStep, kLevels> steps_;
  LazyLevels<RegimeWindow, kLevels> windows_;
  LazyLevels<RegimeChange, kLevels> changes_;
  LazyLevels<RegimeAudit, kLevels> audits_;
  LazyLevels<RegimeForms, 1> forms_;
};

/// x(h); `out_x` may be `x` itself. `inputs` stay as they are.
void apply(const RegimeStep& step, const double* x, const Eigen::VectorXd& inputs, double* out_x);

/// State after a time t from (x, inputs): tabulated steps, then a short Taylor series. In place.
void advance(const RegimeTables& tables, double t, Eigen::VectorXd& x, Eigen::VectorXd& inputs);

}  // namespace slipmode::dynamics
