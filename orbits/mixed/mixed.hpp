#pragma once

#include <slipmode/orbits/periodic_orbit.hpp>
#include <slipmode/orbits/spectrum.hpp>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::orbits {

/// Where Newton's method begins.
struct MixedStart {
  dynamics::State near;      ///< of the part near the contacts
  Eigen::VectorXd coupling;  ///< as MixedOrbit::coupling, of any order
};

struct MixedOptions {
  int order = 1;      ///< period = order × the drive's, ≥ 1
  int harmonics = 9;  ///< H ≥ 1, of that period: of what is far from the contacts
  /// Degrees of freedom coupled to a contact within so many steps are near it; 0: those that contacts act on, alone.
  int reach = 0;
  /// Begun from here first.
  std::optional<MixedStart> guess = {};
  double tolerance = 1e-11;  ///< on the residual, in units of the motion and of the coupling forces
  int max_iterations = 60;   ///< Newton steps in all
};

/// A motion of period T whose part near the contacts is exact, events included, while the rest of the structure is held
/// to H harmonics. No orbit, but near one where H suffices.
struct MixedOrbit {
  bool converged = false;
  std::string message;             ///< what happened when not; empty else
  int order = 1;                   ///< period over that of the drive
  double omega = 0.0;              ///< Ω = 2π/T [rad/s]
  int harmonics = 0;               ///< H
  std::vector<Eigen::Index> near;  ///< degrees of freedom near the contacts, ascending
  int coupled = 0;                 ///< of these, the ones that the rest pulls at
  /// The part near the contacts as a system of its own, driven by the harmonics of the coupling forces. Set when
  /// converged, like what follows.
  std::shared_ptr<const dynamics::HybridSystem> near_system;
  /// Its periodic motion. Multipliers are those of this system alone, the rest held to its harmonics: they say nothing
  /// of stability.
  PeriodicOrbit near_orbit;
  /// Forces of the rest on the near part: of each coupled degree of freedom the constant, cosines 1 … H, sines 1 … H
  /// [N] [coupled · (2H + 1)]
  Eigen::VectorXd coupling;
  Eigen::MatrixXcd rest;  ///< phasors of the other degrees of freedom, q = Re Σ_k rest.col(k) e^{ikΩt} [n − near x H+1]
  double residual = 0.0;  ///< largest
  int iterations = 0;     ///< Newton steps
};

/// Mixed shooting and harmonic balance: M q̈ + C q̇ + K q = p + Σ d u + Σ w λ(q, q̇) parted into degrees of freedom 1
/// near the contacts, in the time domain with their exact events, and the others, R, held to H harmonics:
///
///     D_RR(k) q̂_R,k = f̂_R,k − D_R1(k) q̂_1,k,     D(k) = K + ikΩC − k²Ω²M,     k = 0 … H,
///     M_11 q̈_1 + C_11 q̇_1 + K_11 q_1 = f_1 + W_1 λ + Σ_k Re(ĝ_k e^{ikΩt}),     ĝ_k = −D_1R(k) q̂_R,k,
///
/// solved for (x_1(0), ĝ) with x_1(T) = x_1(0). Newton's method with the exact derivatives of the flow by its start and
/// by its periodic input. A step costs what the near part does, whatever the structure's size. Starts from the linear
/// response without contact, settled near the contacts; else contacts' forces grow from nothing on the way. A guess is
/// tried before.
/// @return  `converged` false, with the best residual, when Newton's method does not arrive
/// @throws InvalidInput  for harmonics < 1, order < 1, reach < 0, a drive that is no force or whose harmonics beyond H
///                       act away from the contacts, laws that the closed form does not hold, a guess for
///                       another near part
/// @throws NumericalFailure  where the rest has no response: it floats, or an undamped mode of it is at a harmonic
/// Source: S3 (3)-(8), coupling forces in place of the displacements q̂_2; docs/theory/mixed-orbits.md.
[[nodiscard]] MixedOrbit mixed_orbit(const dynamics::HybridSystem& system, const MixedOptions& options = {});

/// The lowest order there can be: that of the drive's highest harmonic away from the contacts; else 1.
/// @throws InvalidInput  as mixed_orbit
[[nodiscard]] int least_harmonics(const dynamics::HybridSystem& system, const MixedOptions& options);

/// Degrees of freedom that contacts act on, and those coupled to them within `reach` steps; ascending.
[[nodiscard]] std::vector<Eigen::Index> near_dofs(const dynamics::HybridSystem& system, int reach);

/// Newton's residual and Jacobian at a start of the near part and coupling forces, scaled as `mixed_orbit` solves them:
/// for checks. `point`: (q_1, q̇_1, internal), then the forces at each coupled degree of freedom (constant, cosine
/// 1 … H, sine 1 … H)
struct MixedEquations {
  Eigen::VectorXd point, scale, residual;
  Eigen::MatrixXd jacobian;
};
/// @throws InvalidInput  as mixed_orbit, and for another number of forces
[[nodiscard]] MixedEquations mixed_equations(const dynamics::HybridSystem& system, const MixedOptions& options,
                                             const dynamics::State& near_start, const Eigen::VectorXd& coupling);

/// The state of the whole structure at the start of `near_orbit`.
/// @throws InvalidInput  for one that has not converged
[[nodiscard]] dynamics::State state_of(const dynamics::HybridSystem& system, const MixedOrbit& orbit);

}  // namespace slipmode::orbits
