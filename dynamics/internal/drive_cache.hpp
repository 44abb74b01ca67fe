#pragma once

#include "dynamics/internal/audit_forms.hpp"
#include "dynamics/internal/drive_overlay.hpp"

#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace slipmode::dynamics {

/// A regime under a periodic drive: its steady response, and the audit's forms once they are asked for.
class DrivenRegime {
 public:
  DrivenRegime(const RegimeTables& tables, const ModalModel& slipping, const friction::Drive& drive, bool from_rest)
      : overlay(tables.regime(), slipping, drive, from_rest), tables_(tables), slipping_(slipping) {}

  const DriveOverlay overlay;
  /// Null where there are none.
  [[nodiscard]] const AuditForms* forms() const {
    std::call_once(making_, [&] { forms_ = AuditForms::make(tables_, slipping_, overlay); });
    return forms_.get();
  }

 private:
  const RegimeTables& tables_;
  const ModalModel& slipping_;
  mutable std::once_flag making_;
  mutable std::unique_ptr<AuditForms> forms_;
};

/// What a HybridSystem and its copies under the same drive share: regimes under that drive, each made when first
/// visited.
class DriveCache {
 public:
  /// @param tables, slipping  from the system's own cache @param from_rest  see DriveOverlay
  [[nodiscard]] const DrivenRegime& regime(const RegimeTables& tables, const ModalModel& slipping,
                                           const friction::Drive& drive, bool from_rest) {
    const std::lock_guard lock(making_);
    auto& slot = regimes_[{&tables, from_rest}];
    if (!slot) slot = std::make_unique<DrivenRegime>(tables, slipping, drive, from_rest);
    return *slot;
  }

 private:
  std::mutex making_;
  std::map<std::pair<const RegimeTables*, bool>, std::unique_ptr<DrivenRegime>> regimes_;
};

}  // namespace slipmode::dynamics
