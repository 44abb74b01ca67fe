#pragma once

#include <slipmode/dynamics/regime.hpp>
#include "dynamics/internal/drive_overlay.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace slipmode::dynamics {

/// Work of a stay in a regime [J].
struct StayWork {
  double contact = 0.0;   ///< ∫ Σ λ wᵀq̇ dt
  double drive = 0.0;     ///< ∫ Σ λ v_drive dt
  double viscous = 0.0;   ///< ∫ q̇ᵀCq̇ dt
  double force = 0.0;     ///< ∫ Σ u_k d_kᵀq̇ dt
  double rounding = 0.0;  ///< what these may be off by, differences of larger sums
};

/// Where a stay is.
struct StayPlace {
  double time = 0.0;
  const Eigen::VectorXd& x;         ///< of the regime, less the steady response to a periodic drive
  const Eigen::VectorXd& free;      ///< x_f: less what follows the inputs too
  const Eigen::VectorXd& slipping;  ///< the state in the slipping model
};

/// The energy audit under a harmonic drive without quadrature: with x = x_f + S u, ẋ_f = G x_f, u = (ι, cos θ, sin θ),
/// every power is a quadratic form of (x_f, u), and
///
///     ∫ x_fᵀQ x_f dt = [x_fᵀY x_f],  GᵀY + YG = Q;     ∫ x_fᵀr e^{iθ} dt = Re [x_fᵀy e^{iθ}],  (Gᵀ + iω) y = r.
///
/// The quadratic part of the viscous loss is minus the energy of x_f, as it must be: of many pairs, and where Y says so
/// too, n squares take its place. Costs O(n) then, else O(n²), per stay whatever its length, where quadrature would
/// follow the fastest mode. Constant for a regime under a drive, and safe to share between threads. Source:
/// docs/theory/compliant-contacts.md, section 4. Where a stay is short beside the drive's period, x_f and S u may each
/// be far larger than x, and their squares leave fewer digits than quadrature: StayWork::rounding tells.
class AuditForms {
 public:
  /// Null where a mode has no damping to speak of, or drifts, or the drive has several harmonics: then the integrals
  /// have no such form.
  [[nodiscard]] static std::unique_ptr<AuditForms> make(const RegimeTables& tables, const ModalModel& slipping,
                                                        const DriveOverlay& overlay);

  /// Stays, one after another.
  class Stay {
   public:
    /// @param forms  of the regime entered; they must stay @param inputs  constant over the stay
    void begin(const AuditForms& forms, const StayPlace& at, const Eigen::VectorXd& inputs);
    /// Work since `begin` or the last `until`.
    [[nodiscard]] StayWork until(const StayPlace& at);

   private:
    /// Of each Kind, and the sum of all sizes they are made of.
    struct Values {
      std::array<double, 4> of{};
      double size = 0.0;
      void add(std::size_t kind, double piece) {
        of[kind] += piece;
        size += std::abs(piece);
      }
    };

    [[nodiscard]] double steady(std::size_t kind, double stay, DrivePhase p) const;
    /// The antiderivative of what x_f alone loses.
    [[nodiscard]] double free_loss(const StayPlace& at, DrivePhase p);
    /// Contact work that is a function of the state: −½λ²/K_c of contact springs, ∫λ d(wᵀq) under a load of wᵀq.
    [[nodiscard]] double contact_potential(DrivePhase p, const Eigen::VectorXd& x) const;
    [[nodiscard]] Values values(const StayPlace& at);

    const AuditForms* forms_ = nullptr;
    double begin_ = 0.0;
    Eigen::VectorXd inputs_, resting_;                     ///< of this stay; what the inputs hold
    Eigen::VectorXd lifted_;                               ///< x_f in the slipping model
    std::array<double, 4> along_cosine_{}, along_sine_{};  ///< what cos θ, sin θ come with under these inputs
    Values at_begin_{};
  };

 private:
  /// The powers, in this order.
  enum Kind : std::uint8_t { kContact, kDrive, kViscous, kForce, kKinds };
  /// One power, as a quadratic form of (x_f, u).
  struct Power {
    Eigen::MatrixXd R;  ///< x_fᵀRu [2np x (ni+2)]
    Eigen::MatrixXd P;  ///< uᵀPu [(ni+2) x (ni+2)]
  };
  /// ∫ uᵀPu dt: constant inputs alone move nothing and have no power.
  struct Steady {
    Eigen::VectorXd along_cosine, along_sine;     ///< [ni]
    double cosine = 0.0, sine = 0.0, both = 0.0;  ///< of cos², sin² and cos sin
  };

  AuditForms(const Regime& regime, const RegimeForms& forms, const ModalModel& slipping, const DriveOverlay& overlay);
  [[nodiscard]] bool integrate(Kind kind, const Power& power);
  const Regime& regime_;
  const RegimeForms& forms_;
  const ModalModel& slipping_;
  const DriveOverlay& overlay_;
  /// x_f → what cos θ and sin θ come with in each power [8 x 2np].
  Eigen::MatrixXd harmonic_;
  /// x_f → what two inputs come with in each power, [8 x 2np] for every two.
  std::vector<Eigen::MatrixXd> constant_;
  std::vector<Eigen::Index> acting_;  ///< inputs that may be other than zero in a stay
  std::array<Steady, kKinds> steady_;
  Eigen::MatrixXd held_;  ///< inputs → state in the slipping model that they hold [2np_s x ni]
};

}  // namespace slipmode::dynamics
