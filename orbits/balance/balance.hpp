#pragma once

#include <slipmode/orbits/spectrum.hpp>

#include <optional>
#include <string>
#include <vector>

namespace slipmode::orbits {

/// Where the search for a balance begins.
enum class BalanceStart : std::uint8_t {
  /// The linear response with all stops pressing and all springs of friction sticking, then gaps grown from nothing and
  /// limits lowered to their own; the other where that fails.
  kContact,
  kGap,  ///< the linear response without forces of contact
};

struct BalanceOptions {
  int order = 1;      ///< driven: period = order × the drive's, ≥ 1
  int harmonics = 9;  ///< H ≥ 1, of that period
  int samples = 0;    ///< 0: exact forces; else the alternating scheme with so many, > 2H
  BalanceStart start = BalanceStart::kContact;
  /// Displacements of the contacts to begin with instead, of any order.
  std::vector<Harmonics> guess = {};
  double tolerance = 1e-12;  ///< on the residual, as a share of the largest displacement
  int max_iterations = 60;   ///< Newton steps in all
};

/// A truncated Fourier series that balances the first H harmonics of the equations of motion: no orbit, but near one
/// where H suffices. Coefficients in the order cosine, sine of 0 … H.
struct Balance {
  bool converged = false;
  std::string message;  ///< what happened when not; empty else
  int order = 1;        ///< period over that of the drive
  double omega = 0.0;   ///< Ω, of the first harmonic [rad/s]
  int harmonics = 0, samples = 0;
  std::vector<Harmonics> displacement, force;  ///< of each contact [m], [N]
  Eigen::VectorXd rigid;                       ///< mean amplitudes of the modes that float [nr]
  int switches = 0;                            ///< of all contacts in a period: 0 in the gap, or in stick
  /// Contacts behind springs that never slide. Where their sliders stand, no periodic motion tells: they have the place
  /// nearest to 0 from which none slides.
  int stuck = 0;
  /// Nothing holds some mean displacement: the motion is one of a family, given with the least mean.
  bool family = false;
  double residual = 0.0;  ///< largest entry, as a share of the largest displacement
  int iterations = 0;     ///< Newton steps
};

/// Harmonic balance on the contacts alone: their displacements' coefficients y_k solve
///
///     y_k = e_k + R_k λ_k(y),    R_k = Wᵀ(K + ikΩC − k²Ω²M)⁻¹W,   k = 0 … H,
///
/// with e_k the response to loads and forces, and the mean of what floats free beside them (Zᵀλ_0 + p = 0). Under a
/// shaker friction sees y less the counterpart's displacement. Newton's
/// method with the exact Jacobian; starts that do not converge are led there by growing the gaps and lowering the
/// limits of friction. Cost of a step O((nc H)³), whatever the structure's size; receptances O(n nc² H), once.
/// @return  `converged` false, with the best residual, when Newton's method does not arrive
/// @throws InvalidInput  for harmonics < 1, samples from 1 to 2H, order < 1, a guess for another number of contacts, a
///                       drive without a period, a shaker whose order is above H, and laws other than clearances, tanh
///                       friction and Coulomb friction behind contact springs under constant limits, with what to do
///                       instead
/// Source: docs/theory/harmonic-balance.md, sections 2 and 3; S2's schemes are the exact and the sampled one.
[[nodiscard]] Balance balance(const dynamics::HybridSystem& system, const BalanceOptions& options = {});

/// Newton's residual and Jacobian at a balance's displacements, as `balance` solves them: for checks.
/// Unknowns contact after contact (cosine_0 … cosine_H, sine_1 … sine_H), then `rigid`.
struct BalanceEquations {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};
[[nodiscard]] BalanceEquations balance_equations(const dynamics::HybridSystem& system, const Balance& at);

/// True where a contact's force depends on the motion before: Hill's method does not hold there.
[[nodiscard]] bool has_memory(const dynamics::HybridSystem& system);

/// The state of the whole structure at time 0 that the series stand for, stretches of contact springs with it.
[[nodiscard]] dynamics::State state_of(const dynamics::HybridSystem& system, const Balance& balance);

/// Sizes of the contacts' displacements as the series have them, one per contact.
[[nodiscard]] std::vector<Amplitude> contact_amplitudes(const Balance& balance);

/// y(t) of a series. @param theta  Ωt [rad]
[[nodiscard]] double value_of(const Harmonics& y, double theta);

}  // namespace slipmode::orbits
