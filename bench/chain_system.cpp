#include "bench/chain_system.hpp"

#include <slipmode/diagnostics/model.hpp>
#include <slipmode/fem/chain.hpp>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace slipmode::bench {
namespace {

constexpr double kClearSlip = 0.02;

double slip_speed(const dynamics::HybridSystem& system, const dynamics::State& state) {
  return std::abs(system.drive().velocity(state.time) - system.contacts().front().direction.dot(state.v));
}

dynamics::State onwards(const dynamics::HybridSystem& system, const dynamics::State& state, double duration) {
  const dynamics::SimulateOptions options{.duration = duration, .flow = {.tolerance = 1e-8, .audit = false}};
  return dynamics::simulate(system, state, options).final_state;
}

dynamics::State until_clear_slip(const dynamics::HybridSystem& system, dynamics::State state) {
  constexpr int kTries = 10000;
  for (int i = 0; i < kTries; ++i) {
    if (state.modes.front() != dynamics::ContactMode::kStick && slip_speed(system, state) >= kClearSlip) {
      state.time = 0.0;
      state.modes.clear();
      return state;
    }
    state = onwards(system, state, 0.25);
  }
  throw std::runtime_error("the contact did not slip within 2500 units after the transient");
}

}  // namespace

dynamics::HybridSystem system_of(const ChainProblem& p) {
  fem::ChainOptions chain{.masses = p.n, .damping = p.damping};
  if (p.ground > 0.0) chain.ground_stiffness = {p.ground};
  const friction::Law law = p.coulomb ? friction::Law(friction::Coulomb{p.mu_s, p.mu_k})
                                      : friction::Law(friction::Stribeck{p.mu_s, p.mu_k, p.alpha});
  return {fem::chain(chain), {{Eigen::VectorXd::Unit(p.n, p.n - 1), law, p.load}}, friction::Belt::constant(p.belt)};
}

dynamics::State start_on_attractor(const dynamics::HybridSystem& system, double transient) {
  return until_clear_slip(system, onwards(system, system.rest(), transient));
}

std::vector<dynamics::State> starts_on_attractor(const dynamics::HybridSystem& system, const dynamics::State& first,
                                                 double spacing, int count) {
  std::vector<dynamics::State> starts{first};
  while (static_cast<int>(starts.size()) < count) {
    starts.push_back(until_clear_slip(system, onwards(system, starts.back(), spacing)));
  }
  return starts;
}

}  // namespace slipmode::bench
