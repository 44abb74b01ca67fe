#pragma once

#include "dynamics/lazy_levels.hpp"
#include "dynamics/modal_model.hpp"
#include "dynamics/nodes.hpp"

#include <Eigen/Core>
#include <array>
#include <vector>

namespace slipmode::dynamics {

/// The structure while certain contacts stick, all others sliding under constant forces, as decoupled pairs driven by
/// inputs that are polynomials of time:
///
///     ẋ = G x + B ι,   ι = (ι_1 … ι_nc, V, a, 1),
///
/// where ι_c is the contact's displacement wᵀq if it sticks (it follows the belt: ι̇_c = V, V̇ = a) and its force λ_c if
/// it slides. The output of a sticking contact is its force λ_c, that of a sliding one its velocity wᵀq̇.
///
/// The stuck directions are eliminated with an orthonormal null-space basis of M^{-1/2} w. Source: docs/theory/flow.md.
struct Regime {
  /// @param stuck  which contacts stick
  Regime(const HybridSystem& system, const ModalModel& slipping, const std::vector<bool>& stuck);

  [[nodiscard]] Eigen::Index inputs() const { return static_cast<Eigen::Index>(stuck.size()) + 3; }
  [[nodiscard]] Eigen::Index speed_input() const { return static_cast<Eigen::Index>(stuck.size()); }
  /// ι after a time t.
  void advance_inputs(Eigen::VectorXd& inputs, double t) const;
  /// Output of contact c: its force if it sticks, its velocity if it slides.
  [[nodiscard]] double output(int c, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) const;
  /// Time derivative of an output (row, coefficients): again of that form.
  void differentiate(Eigen::VectorXd& row, Eigen::VectorXd& coefficient) const;
  /// q̇ᵀCq̇ of a state [W].
  [[nodiscard]] double viscous_power(const Eigen::VectorXd& x, double belt_velocity) const;

  std::vector<bool> stuck;
  ModalModel pairs;   ///< only its pairs are used: no contacts
  double rate = 0.0;  ///< fastest rate of the pairs, or of the slipping structure if nothing is left to move [1/s]
  Eigen::MatrixXd B;  ///< [2np x ni]; the drive's columns act through ι as described above
  Eigen::VectorXd B_stuck;      ///< Σ over sticking contacts of their columns of B
  Eigen::MatrixXd row;          ///< outputs, columns [2np x nc]
  Eigen::MatrixXd coefficient;  ///< outputs' dependence on ι, columns [ni x nc]
  Eigen::MatrixXd row1, row2;   ///< first and second derivatives of the outputs
  Eigen::MatrixXd coefficient1, coefficient2;

  Eigen::MatrixXd from_slipping;    ///< state of the slipping model → x [2np x 2np_s]
  Eigen::MatrixXd to_slipping;      ///< x → state of the slipping model [2np_s x 2np]
  Eigen::MatrixXd inputs_slipping;  ///< ι → its part there [2np_s x ni]

  /// For bounds. Each pair is scaled so that its free motion never grows in the Euclidean norm (energy norm for modal
  /// pairs) and its generator has norm `decay`; `particular` is the motion that follows the inputs. Components that are
  /// plain polynomials of time have scale 0: interpolation is exact for them.
  Eigen::VectorXd scale1, scale2;            ///< [np]
  Eigen::VectorXd pair_rate;                 ///< ‖G_i‖ in that scale [np]
  Eigen::MatrixXd particular;                ///< ι → x_p [2np x ni]
  Eigen::MatrixXd weight;                    ///< ‖row_i‖ in that scale [np x nc]
  Eigen::MatrixXd weight2, weight3;          ///< times pair_rate squared, cubed
  Eigen::MatrixXd polynomial2, polynomial3;  ///< ι → second and third derivative of what is polynomial [ni x nc]
  Eigen::VectorXd viscous_cross;             ///< q̇ᵀCq̇ = pairs' + 2V (this·x) + V² viscous_belt [2np]
  double viscous_belt = 0.0;

 private:
  void eliminate(const HybridSystem& system, const ModalModel& slipping);
  void prepare_bounds();
};

/// What a time h does: x(h) = e^{Gh} x + response ι.
struct RegimeStep {
  double h = 0.0;
  Eigen::VectorXd e11, e12, e21, e22;
  Eigen::MatrixXd response;  ///< [2np x ni]
};

/// Outputs over a window of length h as polynomials of degree 7 in Bernstein form, with what interpolation leaves out.
struct RegimeWindow {
  Eigen::MatrixXd from_state;   ///< [8 x 2np nc]
  Eigen::MatrixXd from_inputs;  ///< [8 x ni nc]
  Eigen::MatrixXd remainder;    ///< |output − polynomial| ≤ this column · pair amplitudes [np x nc]
};

/// States at the points of a quadrature rule, for the energy audit.
struct RegimeAudit {
  GaussRule rule;
  std::vector<RegimeStep> point;
};

/// A regime and its tables for windows of length top·2^{-level}, built when first used; safe to share between threads.
class RegimeTables {
 public:
  static constexpr int kLevels = 56;
  /// The first level at which the energy audit's rules are short enough to be tabulated.
  static constexpr int kAuditLevel = 8;

  RegimeTables(const HybridSystem& system, const ModalModel& slipping, const std::vector<bool>& stuck);

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
  [[nodiscard]] const RegimeAudit& audit(int level) const {
    return audits_.get(level, [&](RegimeAudit& out) { make(out, level); });
  }

 private:
  void make(RegimeStep& out, int level) const;
  void make(RegimeWindow& out, int level) const;
  void make(RegimeAudit& out, int level) const;
  void step_of(double h, RegimeStep& out) const;

  Regime regime_;
  std::array<double, kLevels> length_{};
  LazyLevels<RegimeStep, kLevels> steps_;
  LazyLevels<RegimeWindow, kLevels> windows_;
  LazyLevels<RegimeAudit, kLevels> audits_;
};

/// x(h); `out_x` may be `x` itself. `inputs` stay as they are.
void apply(const RegimeStep& step, const double* x, const Eigen::VectorXd& inputs, double* out_x);

/// State after a time t from (x, inputs): tabulated steps, then a short Taylor series. In place. A negative t may be no
/// longer than that series reaches (a quarter of the fastest radian).
void advance(const RegimeTables& tables, double t, Eigen::VectorXd& x, Eigen::VectorXd& inputs);

}  // namespace slipmode::dynamics
