// Built once for every width: see CMakeLists.txt beside it.

#include "core/kernels/internal/kernel_set.hpp"

#define SLIPMODE_TEXT_OF(name) #name
#define SLIPMODE_TEXT(name) SLIPMODE_TEXT_OF(name)

namespace slipmode::kernels::SLIPMODE_KERNEL_SET {

const Kernels kSet{
    .name = SLIPMODE_TEXT(SLIPMODE_KERNEL_SET),
    .dot = dot,
    .product_integral = product_integral,
    .add_scaled = add_scaled,
    .product = product,
    .two_products = two_products,
    .node_sums = node_sums,
    .matrix8 = matrix8,
    .solve_stribeck = solve_stribeck,
    .solve_stick = solve_stick,
    .solve_sliding = solve_sliding,
    .solve_nodes = solve_nodes,
    .two_dots = two_dots,
    .speed_guard = speed_guard,
    .force_guard = force_guard,
    .propagate = propagate,
    .loss = loss,
    .taylor = taylor,
    .taylor_work = taylor_work,
    .free_motion = free_motion,
    .changes = changes,
    .caused = caused,
    .weighted_products = weighted_products,
    .pass = pass,
};

}  // namespace slipmode::kernels::SLIPMODE_KERNEL_SET
