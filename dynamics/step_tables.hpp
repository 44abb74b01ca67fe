#pragma once

#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/dynamics/lazy_levels.hpp>
#include <slipmode/dynamics/modal_model.hpp>
#include <slipmode/dynamics/nodes.hpp>
#include <slipmode/dynamics/pair_motion.hpp>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace slipmode::dynamics {

/// What a step of size h does to the pairs: x(h) = e^{Gh} x(0) + load + Σ_c Σ_j response_cj λ_c(node j).
struct Propagator {
  double h = 0.0;
  Eigen::VectorXd e11, e12, e21, e22;  ///< e^{Gh} [np]
  Eigen::VectorXd load;                ///< ∫ e^{G(h−t)} p dt [2np]
  Eigen::MatrixXd response;            ///< ∫ e^{G(h−t)} b_c ℓ_j(t/h) dt, column 8c + j [2np x 8nc]

  [[nodiscard]] kernels::StepArrays arrays(bool loaded) const {
    return {e11.size(), static_cast<int>(response.cols()), e11.data(),     e12.data(), e21.data(),
            e22.data(), loaded ? load.data() : nullptr,    response.data()};
  }
};

/// A scalar of each contact at the nodes of a step, free x(0) + load + kernel λ: exact for λ of degree 7. Contacts are
/// those of StepTables::acted_on.
struct AtNodes {
  Eigen::MatrixXd free;    ///< rows are nodes: rowᵀ e^{G c_j h}; contact c in columns [2np c, 2np (c+1)) [8 x 2np nc]
  Eigen::MatrixXd load;    ///< [8 x nc]
  Eigen::MatrixXd kernel;  ///< [8nc x 8nc]

  /// Without the forces' share, of the first so many contacts [8nc].
  void without_forces(const double* x, Eigen::Index contacts, double* out) const;
};

/// The scalar Volterra equations of a step: contact velocities w at the nodes.
struct Collocation : AtNodes {
  Eigen::MatrixXd own_kernel;      ///< of what are contacts, without a drive's forces
  double kernel_norm = 0.0;        ///< largest row sum of |own_kernel|
  Eigen::MatrixXd kernel_inverse;  ///< of own_kernel: used when every contact sticks

  /// w [8nc].
  void velocities(const double* x, const double* forces, double* out) const;
};

/// Viscous loss of a step as a form of the state and of the forces at the nodes, exact for forces of degree 7: see
/// kernels::LossArrays. For proportional damping.
struct LossForm {
  Eigen::MatrixXd by_force;       ///< contact c in columns [2np c, 2np (c+1)) [8 x 2np nc]
  Eigen::MatrixXd load;           ///< [8 x nc]
  Eigen::MatrixXd kernel;         ///< column nc c + d: the 8 x 8 block of contacts c and d [64 x nc²]
  Eigen::VectorXd s11, s12, s22;  ///< [np]
  Eigen::VectorXd linear;         ///< [2np]
  double constant = 0.0;

  [[nodiscard]] kernels::LossArrays arrays(Eigen::Index n, bool loaded) const {
    return {n,
            s11.size(),
            static_cast<int>(load.cols()),
            by_force.data(),
            load.data(),
            kernel.data(),
            s11.data(),
            s12.data(),
            s22.data(),
            loaded ? linear.data() : nullptr,
            constant};
  }
};

/// Bounds on the motion within a step of size h, from Σ over the pairs of what each can do: with z a pair scaled so
/// that free motion does not grow (or by e^{growth h} at most), |g_cᵀGᵏe^{Gt}x| ≤ Σ ‖g̃_iᵀG̃_iᵏ‖ |z_i|. Contact
/// velocities v_c, forces of degree 7.
struct StepBounds {
  /// h⁹ max |v_c⁽⁹⁾| ≤ |x|·ninth_by_state + |λ̂|·ninth_by_force + ninth_by_load, λ̂ the forces' Legendre coefficients
  /// [2np x nc], [8nc x nc], [nc]. Holds the rounding of v too, as what it is worth in that measure.
  Eigen::MatrixXd ninth_by_state, ninth_by_force;
  Eigen::VectorXd ninth_by_load;
  /// The forces' share of the first contact by its mean force and by the largest that a value at a node is off it.
  double ninth_by_mean = 0.0, ninth_by_spread = 0.0;
  /// Impulse response γ_cd = g_cᵀe^{Gt}b_d: max over c of Σ_d max |γ_cd⁽ᵏ⁾|, k = 0, 1, 2.
  std::array<double, 3> response{};
  /// γ_cd⁽ᵏ⁾(0) for k = 1, 2 and the load's in the last column [nc x (nc + 1)].
  Eigen::MatrixXd response1, response2;
  Eigen::MatrixXd second_row;      ///< Gᵀ²g_c [2np x nc]
  Eigen::MatrixXd third_by_state;  ///< |g_cᵀG³x(t)| ≤ |x|·this + h (|λ|·third_by_force + third_by_load) [2np x nc]
  Eigen::MatrixXd third_by_force;  ///< [nc x nc]
  Eigen::VectorXd third_by_load;   ///< [nc]
};

/// States at the points of a quadrature rule that integrates squares of velocities to rounding.
struct NodeStates {
  GaussRule rule;
  std::vector<Propagator> node;  ///< propagator to each point, forces given at the nodes of the whole step
};

/// Tables for steps of size top·2^{-level}, built when first used; safe to share between threads.
class StepTables {
 public:
  static constexpr int kLevels = 64;
  /// The largest step spans this many radians of the fastest pair: quadratures are then exact to rounding.
  static constexpr double kLongestPhase = 4.0;

  explicit StepTables(const ModalModel& model);

  [[nodiscard]] double step(int level) const { return top_ / static_cast<double>(std::uint64_t{1} << level); }
  /// How long a law's force acts where a step is held to a tolerance, under a drive of this frequency: a step at its
  /// longest, or as many radians of the drive if these are less [s].
  [[nodiscard]] double acting_time(double omega) const {
    return omega > 0.0 ? std::min(top_, kLongestPhase / omega) : top_;
  }
  [[nodiscard]] const Propagator& propagator(int level) const {
    return propagators_.get(level, [&](Propagator& out) { make(out, level); });
  }
  [[nodiscard]] const Collocation& collocation(int level) const {
    return collocations_.get(level, [&](Collocation& out) { make(out, level); });
  }
  /// What the contacts' displacements wᵀq have changed by since the step's start: the difference is not taken, where a
  /// stiff spring would feel its rounding. Zero along a drive's forces.
  [[nodiscard]] const AtNodes& displacements(int level) const {
    return displacements_.get(level, [&](AtNodes& out) { make(acted_on_.displacement_row, true, level, out); });
  }
  [[nodiscard]] const StepBounds& bounds(int level) const {
    return bounds_.get(level, [&](StepBounds& out) { make(out, level); });
  }
  [[nodiscard]] const ModalModel& model() const { return model_; }
  /// The model whose contacts these tables' forces are of: with a drive's forces, where there are directions for them,
  /// after the contacts' own (`with_given_forces`).
  [[nodiscard]] const ModalModel& acted_on() const { return acted_on_; }
  /// A constant load acts.
  [[nodiscard]] bool loaded() const { return loaded_; }
  /// Work of contacts and drive, and viscous loss, over a whole step. @param forces  at its nodes [8nc] @param
  /// velocities there [8nc]. The contacts' work is exact for velocities of degree 8; what is beyond meets only the
  /// last, small terms of λ.
  [[nodiscard]] kernels::Work work(int level, const double* x, const double* forces, const double* velocities) const;

 private:
  void make(Propagator& out, int level) const;
  void make(Collocation& out, int level) const;
  /// @param change  of the scalars since the step's start
  void make(const Eigen::MatrixXd& rows, bool change, int level, AtNodes& out) const;
  void make(NodeStates& out, int level) const;
  void make(LossForm& out, int level) const;
  void make(StepBounds& out, int level) const;
  /// e^{Gt} − I of all pairs, a column for each time: entries 11, 12, 21 and 22 [4np x times].
  [[nodiscard]] Eigen::MatrixXd changes(const Eigen::VectorXd& times) const;
  /// e^{Gt}.
  [[nodiscard]] Eigen::MatrixXd exponentials(const Eigen::VectorXd& times) const;
  /// Propagator to the time end·h of a step of size h whose forces are given at the nodes of [0, h].
  void propagate_to(double end, double h, Propagator& out) const;

  const ModalModel& model_;
  std::optional<ModalModel> driven_;
  const ModalModel& acted_on_;
  PairMotion motion_;
  double top_;
  bool loaded_;
  LazyLevels<Propagator, kLevels> propagators_;
  LazyLevels<Collocation, kLevels> collocations_;
  LazyLevels<AtNodes, kLevels> displacements_;
  LazyLevels<LossForm, kLevels> losses_;
  LazyLevels<NodeStates, kLevels> node_states_;
  LazyLevels<StepBounds, kLevels> bounds_;
};

}  // namespace slipmode::dynamics
