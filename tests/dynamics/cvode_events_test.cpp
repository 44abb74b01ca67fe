// Event times beside two solvers that share nothing with ours: CVODE with root finding, in the state's own coordinates
// (bench/cvode_peer.cpp), and the Taylor series in extended precision (fixtures/taylor_reference.hpp).

#include <slipmode/dynamics/simulate.hpp>
#include "bench/chain_system.hpp"
#include "bench/cvode_peer.hpp"
#include "fixtures/taylor_reference.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <ostream>
#include <vector>

namespace slipmode::bench {

static void PrintTo(const ChainProblem& problem, std::ostream* out) { *out << problem.name; }

namespace {

using Times = std::vector<double>;

Times event_times(const dynamics::HybridSystem& system, const dynamics::State& start, double duration) {
  Times times;
  for (const auto& event :
       dynamics::simulate(system, start, {.duration = duration, .flow = {.tolerance = 1e-12}}).events) {
    if (event.before != event.after) times.push_back(event.time);
  }
  return times;
}

double largest_difference(const Times& a, const Times& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

class CvodeEvents : public testing::TestWithParam<ChainProblem> {};

// Ours within 1e-9 of the reference, and of CVODE as far as CVODE itself keeps to it: its own error is what chaos makes
// of rtol 1e-12 within 25 units, 6e-10 on one stretch and 1.8e-9 on another.
TEST_P(CvodeEvents, AgreeWithOursAndWithTheTaylorReference) {
  constexpr double kStretch = 25.0;
  constexpr int kStretches = 40;
  const dynamics::HybridSystem system = system_of(GetParam());
  fixtures::TaylorReference<long double> reference(fixtures::reference_of(system));
  std::size_t events = 0;
  double own_error = 0.0, cvode_error = 0.0, difference = 0.0;
  for (const dynamics::State& start :
       starts_on_attractor(system, start_on_attractor(system, 2000.0), kStretch, kStretches)) {
    Times truth;
    for (const auto& event : reference.run(start.q, start.v, 0.0, kStretch).events) truth.push_back(event.time);
    const Times own = event_times(system, start, kStretch);
    const Times cvode = run_cvode_adams(GetParam(), {start.q.begin(), start.q.end()}, {start.v.begin(), start.v.end()},
                                        kStretch, 1e-12, 1e-14)
                            .event_times;
    ASSERT_EQ(own.size(), truth.size());
    ASSERT_EQ(own.size(), cvode.size());
    events += own.size();
    own_error = std::max(own_error, largest_difference(own, truth));
    cvode_error = std::max(cvode_error, largest_difference(cvode, truth));
    difference = std::max(difference, largest_difference(own, cvode));
  }
  EXPECT_GE(events, 40U);
  EXPECT_LE(own_error, 1e-9);
  EXPECT_LE(difference, 1e-9 + cvode_error);
}

INSTANTIATE_TEST_SUITE_P(Chains, CvodeEvents,
                         testing::Values(ChainProblem{.name = "chaotic"}, ChainProblem{.name = "fast", .belt = 0.45},
                                         ChainProblem{.name = "quasi_periodic", .belt = 0.41},
                                         ChainProblem{.name = "slow", .belt = 0.05},
                                         ChainProblem{.name = "coulomb", .coulomb = true}),
                         [](const auto& chain) { return chain.param.name; });

}  // namespace
}  // namespace slipmode::bench
