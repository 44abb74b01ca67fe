#pragma once

#include <slipmode/dynamics/lazy_levels.hpp>
#include <slipmode/dynamics/regime.hpp>
#include <slipmode/friction/drive.hpp>

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

namespace slipmode::dynamics {

/// cos θ and sin θ of a periodic drive's phase θ.
struct DrivePhase {
  double cosine = 1.0, sine = 0.0;

  /// Of jθ, from this of (j − 1)θ.
  [[nodiscard]] DrivePhase times(const DrivePhase& first) const {
    return {cosine * first.cosine - sine * first.sine, sine * first.cosine + cosine * first.sine};
  }
};

/// The steady response of a regime to a periodic drive with harmonics of θ = ωt + phase: a shaker d = A sin θ, or
/// forces. The state of the closed-form flow is what is left beside it, x − Σ_j X_cj cos jθ + X_sj sin jθ, and moves
/// freely: tables of a regime serve every frequency and amplitude.
///
/// Made once for each regime and drive (see DriveCache); safe to share between threads.
///
/// (ijω − G) X_j = B J_j, J_j the drive's part of the inputs, solved at the contacts (see `harmonic_response`).
///
/// A pair that has no steady response to a harmonic, or one far larger than what moves, is left out of X_j: its state
/// is held whole, and the drive moves it on, see `Resonance`. Theory: docs/theory/compliant-contacts.md, section 3.
class DriveOverlay {
 public:
  /// @param from_rest  of forces: no pair that oscillates has a steady response, all are as resonant ones. Steady and
  ///                   free parts of a motion that has just begun are each far larger than both together.
  DriveOverlay(const Regime& regime, const ModalModel& slipping, const friction::Drive& drive, bool from_rest = false);

  /// A pair on the frequency of a harmonic, or next to it: ẋ_i = G_i x_i + Re(push e^{ijθ}) beside what else drives it.
  struct Resonance {
    Eigen::Index pair = 0, order = 1;
    Eigen::Vector2cd push;
    /// What e^{ijθ} moves it from rest in a time tau, as a phasor at the begin: ∫ e^{G(τ−s)} push e^{ijωs} ds.
    [[nodiscard]] Eigen::Vector2cd moved(const Regime& regime, double omega, double tau) const;
  };

  /// Harmonics of each row: value = Σ_j c_j cos jθ + s_j sin jθ.
  struct Amplitudes {
    Amplitudes() = default;
    Amplitudes(Eigen::MatrixXd cosines, Eigen::MatrixXd sines)
        : c(std::move(cosines)), s(std::move(sines)), magnitude((c.cwiseAbs2() + s.cwiseAbs2()).cwiseSqrt()) {}

    Eigen::MatrixXd c, s;       ///< column j − 1 is of order j
    Eigen::MatrixXd magnitude;  ///< hypot(c, s)

    [[nodiscard]] double at(Eigen::Index k, DrivePhase p) const;
    /// Σ_j hypot(c_j, s_j): a bound.
    [[nodiscard]] double size(Eigen::Index k) const { return magnitude.row(k).sum(); }
    /// Adds `factor` times all rows at once.
    void add(DrivePhase p, double factor, Eigen::VectorXd& out) const;
  };

  [[nodiscard]] DrivePhase phase(double t) const;
  /// What the drive moves in a time tau, from phase p on, beside what it did at p to the contacts:
  /// ∫ e^{G(τ−s)} B J(s) ds [2np], contacts' inputs less their values at p. The steady response less that with which it
  /// would have begun, to all digits where these two nearly cancel.
  [[nodiscard]] Eigen::VectorXd from_entry(const Regime& regime, double tau, DrivePhase p) const;
  /// Adds the drive's inputs a time tau after phase p, those of contacts less their values at p.
  void follow_inputs(const Regime& regime, double tau, DrivePhase p, Eigen::VectorXd& out_inputs) const;
  /// Adds that of the resonant pairs under their harmonics.
  void move_resonances(const Regime& regime, double tau, DrivePhase p, Eigen::VectorXd& out_x) const;
  [[nodiscard]] double omega() const { return omega_; }
  [[nodiscard]] Eigen::Index orders() const { return state.c.cols(); }

  Amplitudes state, state_rate;   ///< X, and what of ẋ is not G times the state beside X [2np]
  Amplitudes inputs, input_rate;  ///< J, dJ/dt [ni]
  /// The outputs and their first three derivatives, beside what Regime's rows say of the state [no].
  std::array<Amplitudes, 4> outputs;
  Amplitudes force;         ///< λ of each contact [nc]
  Amplitudes velocity;      ///< wᵀq̇ of each contact [nc]
  Amplitudes displacement;  ///< wᵀq of each contact [nc]
  /// Of what adds up to `displacement`, then to `velocity`: parts by slipping modes, and what those are differences of
  /// where contacts hold what a force moves [2nc].
  Eigen::VectorXd place_size;
  Amplitudes driven;    ///< d_kᵀq̇ of each force direction [nk]
  Amplitudes slipping;  ///< the state in the slipping model [2np_s]
  std::vector<Resonance> resonances;
  Eigen::VectorXd swell;  ///< the most by which they make pairs' sizes grow, in the regime's scales [np, 1/s]

  /// Bernstein coefficients of cos jωτ and sin jωτ over a window 0 ≤ τ ≤ h of this level, and the share of their size
  /// that interpolation leaves out.
  struct Window {
    alignas(64) std::array<double, 8> cosine, sine;
    double remainder = 0.0;
    /// What resonant pairs, from rest, add to the outputs by cos jθ and sin jθ at the begin [8 x no], with what that
    /// leaves out [no]. Empty without.
    Eigen::MatrixXd swell_cosine, swell_sine;
    Eigen::VectorXd swell_remainder;
  };
  /// One per order.
  [[nodiscard]] const std::vector<Window>& window(const Regime& regime, int level, double h) const;

 private:
  /// Whether any pair resonates with a harmonic of this order; keeps those that do. @param load  B J
  /// @param share  see `resonates`
  bool find_resonances(const Regime& regime, Eigen::Index order, const Eigen::VectorXcd& load, double share);
  /// What pushes make of places within a radian of the fastest pair, which these round by.
  void measure_pushes(const Regime& regime, const ModalModel& slipping);
  void differentiate(const Regime& regime);
  void swell_window(const Regime& regime, Eigen::Index order, double h, Window& out) const;

  double omega_ = 0.0, phase_ = 0.0;
  LazyLevels<std::vector<Window>, RegimeTables::kLevels> windows_;
};

}  // namespace slipmode::dynamics
