#pragma once

#include "core/v8.hpp"
#include "dynamics/regime.hpp"
#include "friction/drive.hpp"

#include <Eigen/Core>
#include <array>
#include <optional>

namespace slipmode::dynamics {

/// cos θ and sin θ of a harmonic drive's phase.
struct DrivePhase {
  double cosine = 1.0, sine = 0.0;
};

/// The steady response of a regime to a harmonic drive d = A sin θ, θ = ωt + phase. The state of the closed-form flow
/// is what is left beside it, x − X_c cos θ − X_s sin θ, and moves freely: tables of a regime serve every frequency.
///
/// (iω − G) X = B J pair by pair, J the drive's part of the inputs.
class DriveOverlay {
 public:
  /// @throws NumericalFailure  at resonance with a mode that has no damping: there is no steady response
  DriveOverlay(const Regime& regime, const friction::Shaker& shaker);

  /// A harmonic of each column: value = c cos θ + s sin θ.
  struct Amplitudes {
    Eigen::VectorXd c, s;

    [[nodiscard]] double at(Eigen::Index k, DrivePhase p) const { return c(k) * p.cosine + s(k) * p.sine; }
    /// d/dθ.
    [[nodiscard]] double rate(Eigen::Index k, DrivePhase p) const { return s(k) * p.cosine - c(k) * p.sine; }
    [[nodiscard]] double size(Eigen::Index k) const;
  };

  [[nodiscard]] DrivePhase phase(double t) const;
  [[nodiscard]] double omega() const { return omega_; }

  Amplitudes state;         ///< X [2np]
  Amplitudes inputs;        ///< J [ni]
  Amplitudes outputs;       ///< [no]
  Amplitudes force;         ///< λ of each contact [nc]
  Amplitudes velocity;      ///< wᵀq̇ of each contact [nc]
  Amplitudes displacement;  ///< wᵀq of each contact [nc]

  /// Bernstein coefficients of cos ωτ and sin ωτ over a window 0 ≤ τ ≤ h of this level, and the share of their size
  /// that interpolation leaves out.
  struct Window {
    V8 cosine, sine;
    double remainder = 0.0;
  };
  [[nodiscard]] const Window& window(int level, double h) const;

 private:
  double omega_, phase_;
  mutable std::array<std::optional<Window>, RegimeTables::kLevels> windows_ = {};
};

}  // namespace slipmode::dynamics
