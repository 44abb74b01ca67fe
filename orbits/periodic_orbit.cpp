#include <slipmode/orbits/periodic_orbit.hpp>

#include <slipmode/core/errors.hpp>

#include <string>

namespace slipmode::orbits {

const char* to_string(OrbitKind kind) { return kind == OrbitKind::kDriven ? "driven" : "self-excited"; }

const char* to_string(Stability stability) {
  switch (stability) {
    case Stability::kStable:
      return "stable";
    case Stability::kUnstable:
      return "unstable";
    case Stability::kMarginal:
      return "marginal";
    case Stability::kUnknown:
      return "unknown";
  }
  return "unknown";
}

Eigen::VectorXd stacked(const dynamics::State& state) {
  Eigen::VectorXd x(state.q.size() + state.v.size() + state.internal.size());
  x << state.q, state.v, state.internal;
  return x;
}

dynamics::State with_coordinates(const dynamics::State& like, const Eigen::VectorXd& x) {
  const Eigen::Index n = like.q.size();
  dynamics::State result = like;
  result.q = x.head(n);
  result.v = x.segment(n, n);
  result.internal = x.tail(x.size() - 2 * n);
  return result;
}

dynamics::State advanced(const dynamics::HybridSystem& system, const dynamics::State& state, double duration) {
  return simulate(system, state,
                  {.duration = duration, .keep_events = false, .flow = {.tolerance = 1e-12, .audit = false}})
      .final_state;
}

std::vector<dynamics::State> sample_orbit(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, int count) {
  if (count < 1) throw InvalidInput("an orbit is sampled at 1 point or more, not at " + std::to_string(count));
  std::vector<dynamics::State> points{orbit.start};
  points.reserve(static_cast<std::size_t>(count));
  for (int k = 1; k < count; ++k) points.push_back(advanced(system, points.back(), orbit.period / count));
  return points;
}

}  // namespace slipmode::orbits
