// Built once for every width: see CMakeLists.txt beside it.

#include "core/kernels/internal/kernel_set.hpp"
#include "core/kernels/internal/lanes.hpp"

namespace slipmode::kernels::SLIPMODE_KERNEL_SET {
namespace {

/// Rows of eight that are summed at once: enough sums in flight, and no more than there are registers for. Each sum
/// runs over the columns in their order whatever this is.
#ifdef __AVX512F__
constexpr int kMostBlocks = 10;
#else
constexpr int kMostBlocks = 4;
#endif

/// out_k += A x_k in `blocks` times eight rows.
template <int blocks, int vectors>
SLIPMODE_LANES_INLINE void sum_columns(const double* A, Index rows, Index columns, const double* const* x,
                                       double* const* out) {
  V8 sum[vectors][blocks];
  for (int k = 0; k < vectors; ++k)
    for (int b = 0; b < blocks; ++b) sum[k][b] = load8(out[k] + kLanes * b);
  for (Index j = 0; j < columns; ++j) {
    const double* column = A + rows * j;
    V8 factor[vectors];
    for (int k = 0; k < vectors; ++k) factor[k] = broadcast8(x[k][j]);
    for (int b = 0; b < blocks; ++b) {
      const V8 own = load8(column + kLanes * b);
      for (int k = 0; k < vectors; ++k) sum[k][b] = fma8(own, factor[k], sum[k][b]);
    }
  }
  for (int k = 0; k < vectors; ++k)
    for (int b = 0; b < blocks; ++b) store8(out[k] + kLanes * b, sum[k][b]);
}

template <int vectors>
SLIPMODE_LANES_INLINE void products(const double* A, Index rows, Index columns, const double* const* x,
                                    double* const* out) {
  constexpr int most = kMostBlocks / vectors;
  double* at[vectors];
  for (int k = 0; k < vectors; ++k) at[k] = out[k];
  for (Index left = rows / kLanes; left > 0;) {
    const int blocks = left >= most ? most : left >= 2 ? 2 : 1;
    if (blocks == most)
      sum_columns<most, vectors>(A, rows, columns, x, at);
    else if (blocks == 2)
      sum_columns<2, vectors>(A, rows, columns, x, at);
    else
      sum_columns<1, vectors>(A, rows, columns, x, at);
    if (columns > 0) A += kLanes * blocks;  // without columns there may be no A
    for (int k = 0; k < vectors; ++k) at[k] += kLanes * blocks;
    left -= blocks;
  }
}

}  // namespace

void product(const double* A, Index rows, Index columns, const double* x, double* out) {
  products<1>(A, rows, columns, &x, &out);
}

void two_products(const double* A, Index rows, Index columns, const double* x, const double* y, double* out_x,
                  double* out_y) {
  const double* const from[] = {x, y};
  double* const to[] = {out_x, out_y};
  products<2>(A, rows, columns, from, to);
}

}  // namespace slipmode::kernels::SLIPMODE_KERNEL_SET
