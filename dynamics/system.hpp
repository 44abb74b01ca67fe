#pragma once

#include <slipmode/fem/structure.hpp>
#include <slipmode/friction/contact.hpp>
#include <slipmode/friction/drive.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace slipmode::dynamics {

/// What one contact is doing. The sign of a slip is the sign of v_rel = v_drive − wᵀq̇ (behind a contact spring: of the
/// velocity at which the contact point slides).
enum class ContactMode : std::int8_t {
  kSlipNegative = -1,
  kStick = 0,
  kSlipPositive = 1,
  kSmooth = 2,     ///< a law without stick
  kSeparated = 3,  ///< the normal load is negative: contact is lost
  kGap = 4,        ///< between the stops of a clearance
  kLeftStop = 5,   ///< at the left stop
  kRightStop = 6,
  kLeftFlight = 7,  ///< beyond the left stop's gap, where its force has fallen to zero (ContactLoss::kZeroForce)
  kRightFlight = 8,
};

/// A point of the hybrid state space, in the structure's own degrees of freedom.
struct State {
  double time = 0.0;
  Eigen::VectorXd q;  ///< displacement [n]
  Eigen::VectorXd v;  ///< velocity [n]
  /// One per contact, as a run ended with: where one changes at once, that is an event. Empty: derived from q, v by
  /// consistency (Filippov) when the flow starts.
  std::vector<ContactMode> modes = {};
  /// Contacts' own states, contact after contact (friction::internal_states). Empty: bristles and springs relaxed,
  /// normal oscillators at rest where y holds them.
  Eigen::VectorXd internal = {};
};

class SystemCache;  // modal data and regimes, built when first needed
class DriveCache;   // regimes under a periodic drive, the same

/// M q̈ + C q̇ + K q = p + Σ_k d_k u_k(t) + Σ_c w_c λ_c with contacts and a drive: a full model or a reduced one alike.
///
/// Immutable; copies share the lazily built modal data, which is safe to use from several threads.
class HybridSystem {
 public:
  /// @param load  constant load p [n], or empty for none
  /// @param force_directions  d_k: what the harmonics of a force drive act along, columns [n x nk]; may have none
  /// @throws InvalidInput  for a contact or force direction of wrong size, invalid laws or drive, linearly dependent
  ///                       contacts that cannot share a place, a harmonic along a direction that is not there
  HybridSystem(fem::Structure structure, std::vector<friction::Contact> contacts, friction::Drive drive,
               Eigen::VectorXd load = {}, Eigen::MatrixXd force_directions = {});

  [[nodiscard]] const fem::Structure& structure() const { return structure_; }
  [[nodiscard]] const std::vector<friction::Contact>& contacts() const { return contacts_; }
  [[nodiscard]] const friction::Drive& drive() const { return drive_; }
  [[nodiscard]] const Eigen::VectorXd& load() const { return load_; }
  /// Columns [n x nk], [n x 0] without any.
  [[nodiscard]] const Eigen::MatrixXd& force_directions() const { return force_directions_; }
  [[nodiscard]] Eigen::Index size() const { return structure_.size(); }

  /// The same structure and contacts under another drive: modal data and regimes are shared, so a sweep over belt
  /// speeds, frequencies or amplitudes pays for them once.
  [[nodiscard]] HybridSystem with_drive(friction::Drive drive) const;

  /// The same contacts with other laws and normal loads: modal data are shared, regimes are not.
  /// @throws InvalidInput  for another number of contacts, directions or offsets; for invalid laws
  [[nodiscard]] HybridSystem with_laws(std::vector<friction::Contact> contacts) const;

  /// q = 0, v = 0 at time 0.
  [[nodiscard]] State rest() const;

  /// Number of contacts' own states, of all contacts.
  [[nodiscard]] Eigen::Index internal_size() const;
  /// Index of contact c's first own state in State::internal.
  [[nodiscard]] Eigen::Index internal_begin(int c) const;

  /// ½ vᵀMv + ½ qᵀKq − pᵀq [J]; without what contact springs and bristles store.
  [[nodiscard]] double energy(const State& state) const;

  [[nodiscard]] SystemCache& cache() const { return *cache_; }
  [[nodiscard]] DriveCache& drive_cache() const { return *drive_cache_; }

 private:
  fem::Structure structure_;
  std::vector<friction::Contact> contacts_;
  friction::Drive drive_;
  Eigen::VectorXd load_;
  Eigen::MatrixXd force_directions_;
  std::shared_ptr<SystemCache> cache_;
  std::shared_ptr<DriveCache> drive_cache_;
};

/// Share of a time that contacts stick, mean over those whose law sticks; 0 where none does.
/// @param stick_time  of each contact [s]
[[nodiscard]] double stick_share(const HybridSystem& system, std::span<const double> stick_time, double time);

}  // namespace slipmode::dynamics
