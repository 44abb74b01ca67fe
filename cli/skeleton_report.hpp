#pragma once

#include <slipmode/results/skeleton_store.hpp>
#include "cli/session.hpp"

#include <string>

namespace slipmode::cli {

/// Everything about a skeleton but its paths, orbits numbered from 1.
[[nodiscard]] Json skeleton_json(const results::ModelSkeleton& model);
[[nodiscard]] std::string skeleton_text(const results::ModelSkeleton& model);

/// Differences pair by pair, then what is missed and extra.
[[nodiscard]] Json comparison_json(const orbits::SkeletonComparison& comparison);
[[nodiscard]] std::string comparison_text(const orbits::SkeletonComparison& comparison, const orbits::Skeleton& full,
                                          const orbits::Skeleton& reduced);

}  // namespace slipmode::cli
