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
class DriveOverlay {
 public:
  /// @throws NumericalFailure  at resonance with a mode that has no damping: there is no steady response
  DriveOverlay(const Regime& regime, const ModalModel& slipping, const friction::Drive& drive);

  /// Harmonics of each row: value = Σ_j c_j cos jθ + s_j sin jθ.
  struct Amplitudes {
    Amplitudes() = default;
    Amplitudes(Eigen::MatrixXd cosines, Eigen::MatrixXd sines)
        : c(std::move(cosines)), s(std::move(sines)), magnitude((c.cwiseAbs2() + s.cwiseAbs2()).cwiseSqrt()) {}

    Eigen::MatrixXd c, s;       ///< column j − 1 is of order j
    Eigen::MatrixXd magnitude;  ///< hypot(c, s)

    [[nodiscard]] double at(Eigen::Index k, DrivePhase p) const;
    /// d/dθ and d²/dθ².
    [[nodiscard]] double rate(Eigen::Index k, DrivePhase p) const;
    [[nodiscard]] double bend(Eigen::Index k, DrivePhase p) const;
    /// Σ_j j^power hypot(c_j, s_j): a bound on the derivative of this order.
    [[nodiscard]] double size(Eigen::Index k, int power = 0) const;
    /// Adds `factor` times all rows at once.
    void add(DrivePhase p, double factor, Eigen::VectorXd& out) const;
    /// d/dθ of all rows.
    [[nodiscard]] Eigen::VectorXd rates(DrivePhase p) const;
  };

  [[nodiscard]] DrivePhase phase(double t) const;
  /// What the drive alone moves in a time tau, from phase p on: ∫ e^{G(τ−s)} B J(s) ds [2np]. The steady response less
  /// that with which it would have begun, to all digits where these two nearly cancel.
  [[nodiscard]] Eigen::VectorXd from_rest(const Regime& regime, double tau, DrivePhase p) const;
  [[nodiscard]] double omega() const { return omega_; }
  [[nodiscard]] Eigen::Index orders() const { return state.c.cols(); }

  Amplitudes state;         ///< X [2np]
  Amplitudes inputs;        ///< J [ni]
  Amplitudes outputs;       ///< [no]
  Amplitudes force;         ///< λ of each contact [nc]
  Amplitudes velocity;      ///< wᵀq̇ of each contact [nc]
  Amplitudes displacement;  ///< wᵀq of each contact [nc]
  Amplitudes driven;        ///< d_kᵀq̇ of each force direction [nk]
  Amplitudes slipping;      ///< the state in the slipping model [2np_s]

  /// Bernstein coefficients of cos jωτ and sin jωτ over a window 0 ≤ τ ≤ h of this level, and the share of their size
  /// that interpolation leaves out.
  struct Window {
    alignas(64) std::array<double, 8> cosine, sine;
    double remainder = 0.0;
  };
  /// One per order.
  [[nodiscard]] const std::vector<Window>& window(int level, double h) const;

 private:
  double omega_ = 0.0, phase_ = 0.0;
  LazyLevels<std::vector<Window>, RegimeTables::kLevels> windows_;
};

}  // namespace slipmode::dynamics
