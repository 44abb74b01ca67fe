#pragma once

#include <slipmode/pod/pod.hpp>

#include <Eigen/Core>
#include <optional>

namespace slipmode::pod {

/// Proper orthogonal modes of snapshots that arrive in blocks and need not be kept.
///
/// Holds the triangle R with RᵀR = Σ (x_t − q̄)(x_t − q̄)ᵀ and the mean. A new block of T_b snapshots with mean m_b joins
/// T_a earlier ones with mean m_a by
///
///     RᵀR ← RᵀR + Σ_b (x − m_b)(x − m_b)ᵀ + T_a T_b / (T_a + T_b) (m_b − m_a)(m_b − m_a)ᵀ,
///
/// that is, by QR of R, the block less its own mean and one more row. All three terms are positive, so one pass loses
/// nothing against two. Snapshots are measured from the first one, which keeps the digits of small motion about a large
/// offset. Columns are gathered into fixed groups first: the bytes of the result do not depend on how the stream is
/// cut.
///
/// Memory O(n² + 256 n) whatever the number of snapshots; cost 2 n² per snapshot.
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

  [[nodiscard]] Eigen::Index snapshots() const { return absorbed_ + pending_; }

  /// Modes of everything added so far; more may be added afterwards.
  /// @throws InvalidInput  as pod() does
  [[nodiscard]] PodResult finish() const;

 private:
  void absorb_pending();

  PodOptions options_;
  Eigen::MatrixXd triangle_;  // n x n
  Eigen::MatrixXd group_;     // n x group size, `pending_` columns filled
  Eigen::VectorXd origin_;    // the first snapshot, or zero when the mean stays
  Eigen::VectorXd mean_;      // of the absorbed snapshots, measured from origin_
  Eigen::Index absorbed_ = 0;
  Eigen::Index pending_ = 0;
};

}  // namespace slipmode::pod
