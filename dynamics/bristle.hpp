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

/// The same step varied about its solution: what δs at the nodes and δz at the start do to z and λ at the nodes.
struct BristleVariation {
  RadauTables::Matrix8 z_by_speed;      ///< ∂z_i/∂s_j [s]
  RadauTables::Vector8 z_by_start;      ///< ∂z_i/∂z₀ [—]
  RadauTables::Matrix8 force_by_speed;  ///< ∂λ_i/∂s_j [N s/m]
  RadauTables::Vector8 force_by_start;  ///< ∂λ_i/∂z₀ [N/m]
};
/// @param z  at the nodes, as `solve_bristle` found it [m]
[[nodiscard]] BristleVariation vary_bristle(const friction::BristleForces& law, double direction, double h,
                                            const RadauTables::Vector8& speed, const RadauTables::Vector8& z);

/// z at a share of the step by the polynomial of degree 8 through its start and its nodes.
[[nodiscard]] double bristle_within(double start, const RadauTables::Vector8& z, double share);

}  // namespace slipmode::dynamics
