#pragma once

#include <slipmode/friction/law_kind.hpp>

namespace slipmode::friction {

/// Whether several contacts of such laws may act on one displacement: behind springs and at stops each one's force
/// follows from its own state, whatever acts beside it. What sticks rigidly must be told apart by its motion.
[[nodiscard]] constexpr bool can_share_place(LawKind kind) {
  return kind == LawKind::kCompliant || kind == LawKind::kClearance;
}

}  // namespace slipmode::friction
