#pragma once

#include <slipmode/core/exchange.hpp>
#include <slipmode/pod/pod.hpp>

#include <optional>

namespace slipmode::pod {

/// Proper orthogonal modes of an ensemble whose snapshots lie on several ranks, each of which calls this: pod() of all
/// shares side by side, in the order of the ranks. By QR the result is that of one process to the last bit. Where
/// kAutomatic means Lanczos, that runs on the triangle which QR leaves, not on the snapshots: leading modes to 1e-12.
///
/// Snapshots stay where they are, but for those of a block (see memory) that begins on one rank and ends on others:
/// they go to the first. An ensemble of one block goes to rank 0 whole. Otherwise triangles travel, as a tree that does
/// not depend on the ranks says (TSQR).
///
/// Memory of a rank beside its share, n x n matrices of doubles: 2 for a block's end, log2 B + 2 for its B blocks of
/// max(2 n, 4096) snapshots; rank 0 also what the decomposition of R takes. Cost 2 n² for a snapshot, (2/3) n³ for
/// joining two triangles, one thread a rank. On the network n²/2 numbers for each triangle that is joined elsewhere.
/// @param share     n x T_r, T_r ≥ 0 [m]; n is the same on all ranks
/// @param options   method kAutomatic or kQrSvd
/// @return          on rank 0, when no other waits for a parcel; on others nothing
/// @throws InvalidInput      as pod(): for values that are not finite on the rank that has them; for another method, or
///                           other numbers of rows
/// @throws NumericalFailure  on rank 0, as pod()
/// @throws Interrupted       when the exchange is stopped
/// Source: Demmel, Grigori, Hoemmen & Langou, SIAM J. Sci. Comput. 34 (2012) A206.
[[nodiscard]] std::optional<PodResult> pod_of_ranks(const Eigen::MatrixXd& share, Exchange& exchange,
                                                    const PodOptions& options = {});

}  // namespace slipmode::pod
