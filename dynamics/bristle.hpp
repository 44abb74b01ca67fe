#pragma once

#include <slipmode/dynamics/nodes.hpp>
#include <slipmode/friction/bristle_forces.hpp>

namespace slipmode::dynamics {

/// A step's bristle, eliminated: z and λ at the nodes for given sliding speeds there.
struct BristleStep {
  RadauTables::Vector8 z;      ///< [m]
  RadauTables::Vector8 force;  ///< λ [N]
  RadauTables::Matrix8 slope;  ///< dλ_i/ds_j [N s/m]
};

/// Collocates ż = s − κ(s) z at the eight Radau nodes: linear in z, so one 8 x 8 solution.
/// @param start  z at the beginning of the step [m]
/// @param h      length of the step [s]
/// @param speed  s at the nodes [m/s]
/// @return       entries that are not finite when the equations are singular (only past s = 0)
[[nodiscard]] BristleStep solve_bristle(const friction::BristleForces& law, double direction, double start, double h,
                                        const RadauTables::Vector8& speed);

/// z at a share of the step by the polynomial of degree 8 through its start and its nodes.
[[nodiscard]] double bristle_within(double start, const RadauTables::Vector8& z, double share);

}  // namespace slipmode::dynamics
