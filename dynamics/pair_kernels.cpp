#include "dynamics/pair_kernels.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace slipmode::dynamics {
namespace {

constexpr int kTaylorOrder = 12;

/// x(tau) by Taylor series; forces are polynomials through the nodes of a step of size h.
template <Load load>
void taylor(const ModalModel& m, const double* x, const double* forces, double h, double tau, double* out_x) {
  const auto np = m.np;
  alignas(64) double stack_coefficients[kNodes * 4];
  std::vector<double> heap;
  double* coefficient = stack_coefficients;  // of (t/tau)^k, contact after contact
  if (m.contacts > 4) {
    heap.resize(static_cast<std::size_t>(kNodes * m.contacts));
    coefficient = heap.data();
  }
  for (int c = 0; c < m.contacts; ++c) {
    alignas(64) double monomial[kNodes];
    store8(monomial, matrix8_times(radau().monomial.data(), forces + kNodes * c));
    double power = tau;
    for (int k = 0; k < kNodes; ++k, power *= tau / h) coefficient[kNodes * c + k] = monomial[k] * power;
  }
  for (Eigen::Index i = 0; i < np; i += kLanes) {
    const V8 g11 = load8(m.g11.data() + i) * tau, g12 = load8(m.g12.data() + i) * tau;
    const V8 g21 = load8(m.g21.data() + i) * tau, g22 = load8(m.g22.data() + i) * tau;
    V8 y1 = load8(x + i), y2 = load8(x + np + i), sum1 = y1, sum2 = y2;
    for (int k = 0; k < kTaylorOrder; ++k) {
      V8 next1 = g11 * y1 + g12 * y2, next2 = g21 * y1 + g22 * y2;
      if (load == Load::kIncluded && k == 0) {
        next1 += load8(m.load.data() + i) * tau;
        next2 += load8(m.load.data() + np + i) * tau;
      }
      if (k < kNodes)
        for (int c = 0; c < m.contacts; ++c) {
          const double* b = m.input.data() + 2 * np * c;
          next1 += load8(b + i) * coefficient[kNodes * c + k];
          next2 += load8(b + np + i) * coefficient[kNodes * c + k];
        }
      y1 = next1 * (1.0 / (k + 1));
      y2 = next2 * (1.0 / (k + 1));
      sum1 += y1;
      sum2 += y2;
    }
    store8(out_x + i, sum1);
    store8(out_x + np + i, sum2);
  }
}

}  // namespace

template <Load load>
void propagate(const Propagator& p, const double* x, const double* forces, int contacts, Eigen::Index np,
               double* out_x) {
  const int columns = kNodes * contacts;
  for (Eigen::Index i = 0; i < np; i += kLanes) {
    const V8 x1 = load8(x + i), x2 = load8(x + np + i);
    V8 y1 = load8(p.e11.data() + i) * x1;
    V8 z1 = load8(p.e12.data() + i) * x2;
    V8 y2 = load8(p.e21.data() + i) * x1;
    V8 z2 = load8(p.e22.data() + i) * x2;
    if (load == Load::kIncluded) {
      y1 += load8(p.load.data() + i);
      y2 += load8(p.load.data() + np + i);
    }
    const double* response = p.response.data() + i;
    for (int j = 0; j < columns; j += 2) {
      y1 += load8(response) * forces[j];
      y2 += load8(response + np) * forces[j];
      z1 += load8(response + 2 * np) * forces[j + 1];
      z2 += load8(response + 3 * np) * forces[j + 1];
      response += 4 * np;
    }
    store8(out_x + i, y1 + z1);
    store8(out_x + np + i, y2 + z2);
  }
}

template <Load load>
void advance_within(const StepTables& tables, const double* x, const double* forces, int level, double tau,
                    double* out_x) {
  const ModalModel& m = tables.model();
  const double* from = x;
  walk_pieces(
      tables, forces, level, tau,
      [&](int piece, const double* piece_forces) {
        propagate<load>(tables.propagator(piece), from, piece_forces, m.contacts, m.np, out_x);
        from = out_x;
      },
      [&](int piece, const double* piece_forces, double rest) {
        taylor<load>(m, from, piece_forces, tables.step(piece), rest, out_x);
        from = out_x;
      });
  if (from == x) std::copy_n(x, 2 * m.np, out_x);
}

template void propagate<Load::kIncluded>(const Propagator&, const double*, const double*, int, Eigen::Index, double*);
template void propagate<Load::kLeftOut>(const Propagator&, const double*, const double*, int, Eigen::Index, double*);
template void advance_within<Load::kIncluded>(const StepTables&, const double*, const double*, int, double, double*);
template void advance_within<Load::kLeftOut>(const StepTables&, const double*, const double*, int, double, double*);

double viscous_loss(const StepTables& tables, int level, const double* x, const double* forces) {
  const ModalModel& m = tables.model();
  const NodeStates& nodes = tables.node_states(level);
  const int columns = kNodes * m.contacts;
  const auto np = m.np;
  const auto points = nodes.rule.weight.size();
  double total = 0.0;
  if (!m.proportional) {
    Eigen::VectorXd state(2 * np);
    for (Eigen::Index j = 0; j < points; ++j) {
      propagate(nodes.node[static_cast<std::size_t>(j)], x, forces, m.contacts, np, state.data());
      total += nodes.rule.weight(j) * m.viscous_power(state);
    }
    return total * tables.step(level);
  }
  for (Eigen::Index i = 0; i < np; i += kLanes) {
    const V8 x1 = load8(x + i), x2 = load8(x + np + i);
    V8 sum{};
    for (Eigen::Index j = 0; j < points; ++j) {
      const Propagator& p = nodes.node[static_cast<std::size_t>(j)];
      V8 y = load8(p.load.data() + np + i) + load8(p.e21.data() + i) * x1;
      V8 z = load8(p.e22.data() + i) * x2;
      const double* response = p.response.data() + np + i;
      for (int k = 0; k < columns; k += 2) {
        y += load8(response) * forces[k];
        z += load8(response + 2 * np) * forces[k + 1];
        response += 4 * np;
      }
      sum += nodes.rule.weight(j) * (y + z) * (y + z);
    }
    total += sum8(load8(m.damping.data() + i) * sum);
  }
  return total * tables.step(level);
}

}  // namespace slipmode::dynamics
