#pragma once

#include "fem/structure.hpp"
#include "friction/contact.hpp"
#include "friction/drive.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace slipmode::dynamics {

/// What one contact is doing. The sign of a slip is the sign of v_rel = v_drive − wᵀq̇.
enum class ContactMode : std::int8_t { kSlipNegative = -1, kStick = 0, kSlipPositive = 1, kSmooth = 2 };

/// A point of the hybrid state space, in the structure's own degrees of freedom.
struct State {
  double time = 0.0;
  Eigen::VectorXd q;  ///< displacement [n]
  Eigen::VectorXd v;  ///< velocity [n]
  /// One per contact; empty: derived from q, v by consistency (Filippov) when the flow starts.
  std::vector<ContactMode> modes = {};
};

class SystemCache;  // modal data and regimes, built when first needed

/// M q̈ + C q̇ + K q = p + Σ_c w_c λ_c with friction contacts and a belt: a full model or a reduced one alike.
///
/// Immutable; copies share the lazily built modal data, which is safe to use from several threads.
class HybridSystem {
 public:
  /// @param load  constant load p [n], or empty for none
  /// @throws InvalidInput  for a contact direction of wrong size, invalid laws or drive, linearly dependent contacts
  HybridSystem(fem::Structure structure, std::vector<friction::Contact> contacts, friction::Drive drive,
               Eigen::VectorXd load = {});

  [[nodiscard]] const fem::Structure& structure() const { return structure_; }
  [[nodiscard]] const std::vector<friction::Contact>& contacts() const { return contacts_; }
  [[nodiscard]] const friction::Drive& drive() const { return drive_; }
  [[nodiscard]] const Eigen::VectorXd& load() const { return load_; }
  [[nodiscard]] Eigen::Index size() const { return structure_.size(); }

  /// The same structure and contacts under another drive: modal data and regimes are shared, so a sweep over the belt
  /// speed pays for them once.
  [[nodiscard]] HybridSystem with_drive(friction::Drive drive) const;

  /// q = 0, v = 0 at time 0.
  [[nodiscard]] State rest() const;

  /// ½ vᵀMv + ½ qᵀKq − pᵀq [J].
  [[nodiscard]] double energy(const State& state) const;

  [[nodiscard]] SystemCache& cache() const { return *cache_; }

 private:
  fem::Structure structure_;
  std::vector<friction::Contact> contacts_;
  friction::Drive drive_;
  Eigen::VectorXd load_;
  std::shared_ptr<SystemCache> cache_;
};

}  // namespace slipmode::dynamics
