#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/dynamics/simulate.hpp>

#include <Eigen/Core>
#include <functional>
#include <numbers>

namespace slipmode::diagnostics {

/// An exponent counts as positive above so many standard errors.
inline constexpr double kErrorsOfPositive = 4.0;

/// The largest Lyapunov exponent, per unit of time.
struct LyapunovExponent {
  double nats = 0.0;   ///< growth rate of a small distance [1/s]
  double bits = 0.0;   ///< nats / ln 2, the unit of S4 (3.25)
  double error = 0.0;  ///< standard error of `nats` from the scatter of eight equal stretches [1/s]
  int renormalisations = 0;

  [[nodiscard]] double error_bits() const { return error / std::numbers::ln2; }
  [[nodiscard]] bool is_positive() const { return nats > kErrorsOfPositive * error; }
};

struct LyapunovOptions {
  double transient = 1000.0;  ///< run before measuring [s]
  double duration = 20000.0;  ///< measured over [s]
  double interval = 20.0;     ///< between renormalisations [s]
  double separation = 1e-7;   ///< distance after each renormalisation over the motion's size, largest so far
  std::uint64_t seed = 1;     ///< direction of the first separation
  dynamics::FlowOptions flow = {};
  const StopFlag* stop = nullptr;  ///< polled at renormalisations
};

/// Benettin's two-trajectory method for any map: the mean log growth per application of `step`, divided by `time_step`.
/// @param step       the map, state [m] → state [m]
/// @param direction  first separation, not zero [m]
/// Source: Benettin, Galgani, Giorgilli, Strelcyn, Meccanica 15 (1980).
[[nodiscard]] LyapunovExponent benettin(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& step,
                                        Eigen::VectorXd state, Eigen::VectorXd direction, int steps, double time_step,
                                        double separation);

/// Largest exponent of a hybrid system by two trajectories, distance √(½ δvᵀMδv + ½ δqᵀKδq) (energy norm), a motion's
/// size the norm of its state, or of a contact that moves with its counterpart where that is larger. While a contact of
/// the reference sticks, the neighbour is put on the same belt speed: that direction is lost anyway. Contacts' own
/// states belong to the state; a stretch δz counts ½ K_c δz². Under a shaker start.time sets the phase.
/// @throws InvalidInput  for non-positive times or separation
[[nodiscard]] LyapunovExponent largest_exponent(const dynamics::HybridSystem& system, const dynamics::State& start,
                                                const LyapunovOptions& options = {});

}  // namespace slipmode::diagnostics
