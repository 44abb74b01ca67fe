#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace slipmode::bench {

/// The chain every row of the table simulates: n masses of 1, springs of 1 (left end fixed), a ground spring on each,
/// C = damping·K, friction on the last mass from a belt of constant speed. Coulomb when alpha = 0 and mu_s > mu_k.
struct ChainProblem {
  std::string name;
  int n = 10;
  double ground = 0.0;
  double damping = 0.006;
  double mu_s = 0.4, mu_k = 0.2, load = 3.0;
  double alpha = 8.0;  ///< Stribeck decay; unused when `coulomb`
  bool coulomb = false;
  double belt = 0.2;
};

/// One event-driven run of a peer.
struct PeerRun {
  std::vector<double> q, v;         ///< state at the end, n each
  std::vector<double> event_times;  ///< every change of the contact's mode
  long steps = 0;
};

/// Accelerations of the chain without the contact's force: −K(x + c v), one pass, no branches in the loop.
/// @param x, v   n values each
/// @param out_a  n values
inline void chain_acceleration(const ChainProblem& p, const double* __restrict x, const double* __restrict v,
                               double* __restrict out_a) {
  const int n = p.n;
  const double c = p.damping, middle = 2.0 + p.ground, last = 1.0 + p.ground;
  if (n == 1) {
    out_a[0] = -last * (x[0] + c * v[0]);
    return;
  }
  out_a[0] = (x[1] + c * v[1]) - middle * (x[0] + c * v[0]);
  for (int i = 1; i < n - 1; ++i) {
    out_a[i] = (x[i - 1] + x[i + 1] - middle * x[i]) + c * (v[i - 1] + v[i + 1] - middle * v[i]);
  }
  out_a[n - 1] = (x[n - 2] + c * v[n - 2]) - last * (x[n - 1] + c * v[n - 1]);
}

}  // namespace slipmode::bench
