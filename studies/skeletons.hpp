#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/orbits/skeleton_compare.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/results/skeleton_store.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/run_options.hpp>

#include <memory>
#include <optional>
#include <string>
#include <tuple>

namespace slipmode::studies {

struct SkeletonRequest {
  double duration = 0.0;
  std::optional<double> transient = {};
  int max_length = 12, per_length = 16;
  double threshold = 0.5, apart = 0.5, radius = 0.4, tolerance = 5e-11;

  static constexpr auto fields() {
    using Own = SkeletonRequest;
    return std::tuple{
        optional("duration", &Own::duration, "s", "time recorded; 0: 200 times what [time] keeps", kNonNegative),
        optional("transient", &Own::transient, "s", "time left out before it; without: as [time] says", kNonNegative),
        optional("max_length", &Own::max_length, "", "longest orbits looked for, in passages of the section", kCount),
        optional("per_length", &Own::per_length, "", "candidates of each length", kCount),
        optional("threshold", &Own::threshold, "1", "largest distance of a close return", kPositive),
        optional("apart", &Own::apart, "1", "candidates of one length differ by this at least", kNonNegative),
        optional("radius", &Own::radius, "1", "distance within which the attractor counts as near an orbit", kPositive),
        optional("tolerance", &Own::tolerance, "1", "bound on an orbit's relative mismatch after a period", kPositive)};
  }
};

/// The unstable periodic orbits of a model's chaotic motion, from a record of it.
/// @throws Interrupted  when the stop flag was set
[[nodiscard]] results::ModelSkeleton skeleton(const Family& model, const SkeletonRequest& request,
                                              const RunOptions& run = {});

/// Skeletons of a scene's full and reduced model, each also tried from the other's orbits, and both compared in the
/// full one's metric.
struct SkeletonPair {
  results::ModelSkeleton full, reduced;
  orbits::SkeletonComparison comparison;
};
/// @throws Interrupted  when the stop flag was set
[[nodiscard]] SkeletonPair skeletons(const Family& full, const Family& reduced, const SkeletonRequest& request,
                                     const RunOptions& run = {});

/// What is kept. @param model_word  the model, or the reduced one, as the executable is given it
[[nodiscard]] results::Content content_of(const Family& model, std::shared_ptr<const results::ModelSkeleton> skeleton,
                                          const std::string& model_word, const SkeletonRequest& request);
[[nodiscard]] results::Content content_of(const Family& reduced, std::shared_ptr<const SkeletonPair> pair,
                                          const std::string& model_word, const SkeletonRequest& request);

}  // namespace slipmode::studies
