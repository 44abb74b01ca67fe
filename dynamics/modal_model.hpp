#pragma once

#include <slipmode/dynamics/system.hpp>

#include <Eigen/Core>
#include <algorithm>
#include <optional>

namespace slipmode::dynamics {

/// The lanes of a vector register that pairs are padded to.
inline constexpr Eigen::Index kLanes = 8;
/// `count` rounded up to a whole number of lanes.
constexpr Eigen::Index padded(Eigen::Index count) { return (count + kLanes - 1) / kLanes * kLanes; }

/// The structure in its undamped natural modes q = Φ η: η̈ + D η̇ + diag(ω²) η = p + Σ w_c λ_c.
struct ModalCoordinates {
  Eigen::VectorXd omega;       ///< ω [n, rad/s]
  Eigen::MatrixXd damping;     ///< D = ΦᵀCΦ [n x n]
  Eigen::MatrixXd directions;  ///< Φᵀw, columns [n x nc]
  Eigen::VectorXd load;        ///< Φᵀp [n]
  Eigen::MatrixXd forces;      ///< Φᵀd, columns [n x nk]
  /// η = to_eta x, η̇ = to_eta_rate x; x = from_eta η + from_eta_rate η̇ [n x 2np], [2np x n].
  Eigen::MatrixXd to_eta, to_eta_rate, from_eta, from_eta_rate;
};

/// The slipping structure in decoupled first-order form: n independent pairs x = (x₁, x₂),
///
///     ẋ = G x + Σ_c b_c λ_c + p,      wᵀq = u_cᵀ x,      wᵀq̇ = g_cᵀ x,
///
/// G block diagonal with 2 x 2 blocks. With proportional damping a pair is a modal displacement and velocity and
/// G = [0 1; −ω² −d]; otherwise it is the real form of a complex pair (or two real eigenvalues) of the state matrix.
/// Pairs are stored one array per component, padded with zeros to whole vectors: lane i of first and lane i of second
/// form pair i. A state vector is [x₁ (np); x₂ (np)].
struct ModalModel {
  Eigen::Index n = 0;   ///< pairs (= degrees of freedom)
  Eigen::Index np = 0;  ///< n padded to a multiple of 8
  int contacts = 0;
  int given = 0;  ///< the last so many contacts are directions of a drive's forces, see `with_given_forces`

  Eigen::VectorXd g11, g12, g21, g22;  ///< blocks of G [np]
  Eigen::MatrixXd input;               ///< b_c, columns [2np x nc]
  Eigen::VectorXd load;                ///< p [2np]
  Eigen::MatrixXd force_input;         ///< what a unit force along d_k adds to ẋ, columns [2np x nk]
  Eigen::MatrixXd force_row;           ///< d_kᵀq̇ = this·x, columns [2np x nk]
  Eigen::MatrixXd displacement_row;    ///< u_c, columns [2np x nc]
  Eigen::MatrixXd velocity_row;        ///< g_c, columns [2np x nc]
  /// |w_c|ᵀ|Q|, then |w_c|ᵀ|V|: wᵀq and wᵀq̇ have parts of this·|x| [2np x 2nc]. Empty without Q and V.
  Eigen::MatrixXd place_row;
  Eigen::MatrixXd acceleration_row;    ///< Gᵀ g_c: wᵀq̈ = this·x + g_cᵀ(Σ b λ + p) [2np x nc]
  Eigen::MatrixXd mobility;            ///< g_cᵀ b_d = (Wᵀ M⁻¹ W)_cd [nc x nc]
  Eigen::VectorXd load_acceleration;   ///< g_cᵀ p [nc]
  Eigen::MatrixXd force_acceleration;  ///< what a unit force along d_k adds to wᵀq̈ [nc x nk]
  Eigen::VectorXd contact_offset;      ///< [nc]
  double fastest = 0.0;                ///< largest |eigenvalue| of G [1/s]

  bool proportional = true;
  std::optional<fem::Rayleigh> rayleigh;  ///< set when all dampings fit a + b ω²
  Eigen::VectorXd omega, damping;         ///< proportional: ω [rad/s], d = φᵀCφ [1/s], padded

  /// q = Q x, q̇ = V x; x = Xq q + Xv q̇ [n x 2np], [2np x n]. Empty when only the contacts' rows were computed.
  Eigen::MatrixXd to_q, to_v, from_q, from_v;
  ModalCoordinates modal;  ///< empty when only the contacts' rows were computed
  /// q̇ᵀCq̇ = |L x|² where modal dampings do not give it: for damping that is not proportional, and where stops add to it
  /// [n x 2np].
  Eigen::MatrixXd dissipation_root;

  /// Sets `fastest` from the blocks of G.
  void measure_rates();
  /// q̇ᵀCq̇ of a state [W].
  [[nodiscard]] double viscous_power(const Eigen::Ref<const Eigen::VectorXd>& x) const;
  /// The same as a bilinear form of two states.
  [[nodiscard]] double viscous_power(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const;
  /// ẋ under these contact forces and the constant load.
  [[nodiscard]] Eigen::VectorXd rate(const Eigen::VectorXd& x, const Eigen::VectorXd& force) const;
  /// Nothing has a stiffness.
  [[nodiscard]] bool floats() const { return (proportional ? omega : modal.omega).isZero(0.0); }
  /// What times are measured by: the fastest rate, and 1/s at least where nothing has a stiffness. How slowly light
  /// damping makes a motion decay is no measure of what happens in it [1/s].
  [[nodiscard]] double pace() const { return floats() ? std::max(fastest, 1.0) : fastest; }
  [[nodiscard]] bool has_shapes() const { return to_q.size() > 0; }
  /// e^{G_i t} of pair i as {a, b; c, d}, of oscillating, critical, overdamped and rigid-body pairs.
  [[nodiscard]] Eigen::Matrix2d exponential(Eigen::Index pair, double t) const;
  /// e^{G_i t} − I, to rounding of what its rates make of a state in that time, however short and far from the origin.
  [[nodiscard]] Eigen::Matrix2d change(Eigen::Index pair, double t) const;
};

/// R with RᵀR = (A + Aᵀ)/2, for an A that is positive semi-definite.
[[nodiscard]] Eigen::MatrixXd square_root(const Eigen::MatrixXd& A);

/// Turns rigid-body modes (ω = 0) within their own space so that damping does not couple them to one another, and sets
/// to zero what damping leaves of a mode it does not act on: such a mode then decouples exactly.
/// @param omega   [m]; @param shapes  in whatever coordinates, columns [n x m]; turned
/// @param damping  in these modes [m x m]; turned with them
/// @param damping_size  norm of the whole structure's: what rounding is a share of, however little of it is left here
/// @param coupled  directions in these modes along which further terms will act, columns, or null; turned with them:
///                 modes that these reach are separated from those that they do not, and each by itself as above
void separate_rigid_modes(const Eigen::VectorXd& omega, Eigen::MatrixXd& shapes, Eigen::MatrixXd& damping,
                          double damping_size, Eigen::MatrixXd* coupled = nullptr);

/// Builds the model. Rows only: a long chain's frequencies and contact rows without mode shapes, O(n²).
/// @throws NumericalFailure  when damping is not proportional and the state matrix is close to defective
[[nodiscard]] ModalModel build_modal_model(const HybridSystem& system, bool rows_only);

/// The same pairs with the directions of a drive's forces after the contacts, as contacts whose force is given: what a
/// step sees. Without the drive's displacements, offsets and mode shapes.
[[nodiscard]] ModalModel with_given_forces(const ModalModel& model);

}  // namespace slipmode::dynamics
