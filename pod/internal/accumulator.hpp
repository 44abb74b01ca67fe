#pragma once

#include <slipmode/pod/pod.hpp>
#include "pod/internal/snapshot_blocks.hpp"

#include <Eigen/Core>

namespace slipmode::pod {

/// Proper orthogonal modes of snapshots that arrive in pieces and need not be kept. The bytes of the result do not
/// depend on how the stream is cut (snapshot_blocks.hpp).
///
/// Memory O(n² log(T/n) + 256 n) for T snapshots; cost 2 n² per snapshot.
///
///     PodAccumulator pod(10, {.choice = {.energy = 0.99}});
///     for (const auto& run : runs) pod.add(run.q);
///     const PodResult result = pod.finish();
class PodAccumulator {
 public:
  /// @param dofs     n ≥ 1
  /// @param options  method kAutomatic or kQrSvd
  /// @throws InvalidInput  for n < 1, another method, or a mode choice out of range
  explicit PodAccumulator(Eigen::Index dofs, const PodOptions& options = {});

  /// @param block  n x b, b ≥ 0 [m]
  /// @throws InvalidInput  for a wrong number of rows or a value that is not finite (the block is then not added)
  void add(const Eigen::Ref<const Eigen::MatrixXd>& block);

  [[nodiscard]] Eigen::Index snapshots() const { return snapshots_; }

  /// Modes of everything added so far; more may be added afterwards.
  /// @throws InvalidInput  as pod() does
  [[nodiscard]] PodResult finish() const;

 private:
  PodOptions options_;
  Eigen::Index dofs_;
  BlockStream blocks_;
  Eigen::Index snapshots_ = 0;
};

/// Modes of snapshots of which this is left, where kAutomatic says so by Lanczos on the triangle.
/// @throws InvalidInput  as pod() does
[[nodiscard]] PodResult modes_of(const SnapshotTriangle& sum, const PodOptions& options);

}  // namespace slipmode::pod
