#include "dynamics/internal/collocation_flow.hpp"
#include "dynamics/internal/left_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

// How far a bristle's true motion may be from the computed one: docs/theory/bristle-laws.md.

namespace slipmode::dynamics {

CollocationFlow::BristleDefect CollocationFlow::bristle_defect(int c, double reach, double h, bool at_rest) const {
  // In the direction of sliding: ż = s − κ(s) z, κ = σ0 s/g, g even and not growing with |s|.
  const auto i = static_cast<std::size_t>(c);
  const friction::BristleForces& law = laws()[i].bristle;
  const double sign = sign_of(point_.modes[i]), between = nodes_.remainder[0] * ninth_.maxCoeff();
  alignas(64) const RadauTables::Vector8 s =
      sign * (drive_nodes_.segment<kNodes>(kNodes * c) - velocity_.segment<kNodes>(kNodes * c));
  alignas(64) const RadauTables::Vector8 z = sign * bristle_nodes_.segment<kNodes>(kNodes * c);
  const double s_begin = guard_start_(c), z_begin = sign * internal_begin_(own_at_[i]);
  const ChebyshevSeries speed(kernels_, s_begin, s), bristle(kernels_, z_begin, z);
  RadauTables::Vector8 rate;
  for (int j = 0; j < kNodes; ++j) rate(j) = law.rate(1.0, s(j), z(j));
  // Newton's and the linear solution's rests, at the nodes.
  const RadauTables::Vector8 force = law.stiffness * z + law.damping * rate + law.viscous * s;
  const double left = (sign * forces_.segment<kNodes>(kNodes * c) - force).cwiseAbs().maxCoeff();
  const RadauTables::Vector8 missing = z - RadauTables::Vector8::Constant(z_begin) - h * (nodes_.integral * rate);
  const double off = nodes_.lebesgue * (missing.array() / nodes_.node.array()).abs().maxCoeff();

  BristleDefect out;
  const double fastest = fastest_slip(c);
  out.room = at_rest ? fastest : 0.5 * (guard_least_(c) - between);
  const double slow = at_rest ? 0.0 : out.room, fast = fastest + between + out.room;
  const auto share = [&](double v) { return v * v / (law.stribeck_speed * law.stribeck_speed); };
  const auto limit = [&](double v) { return law.kinetic + law.drop * std::exp(-share(v)); };
  const auto bend = [&](double v) { return share(v) * std::exp(-share(v)); };  // −s g′/(2 drop)
  const double most_bend = share(slow) <= 1.0 && share(fast) >= 1.0 ? std::exp(-1.0) : std::max(bend(slow), bend(fast));
  const double g_slow = limit(slow), g_fast = limit(fast);
  const double slopes[] = {law.stiffness * (1.0 + 2.0 * law.drop * std::min(bend(slow), bend(fast)) / g_slow) / g_slow,
                           law.stiffness * (1.0 + 2.0 * law.drop * most_bend / g_fast) / g_fast};
  double by_speed = 0.0;  // of ż
  for (const double slope : slopes)
    for (const double side : {-1.0, 1.0})
      by_speed = std::max(by_speed, std::abs(1.0 - slope * (bristle.mean + side * (bristle.spread() + off))));
  const double decay = law.stiffness * slow / g_slow, most_decay = law.stiffness * fast / g_fast;
  const double by_bristle =
      std::max(std::abs(law.stiffness - law.damping * decay), std::abs(law.stiffness - law.damping * most_decay));

  // What the nodes leave out of ż: a bound on s, z and 1/g on ellipses.
  const PerEllipse s_swing = speed.swing(), z_most = std::abs(bristle.mean) + bristle.swing();
  const double stribeck = law.drop * std::exp(-share(speed.mean));
  PerEllipse g = PerEllipse::Constant(law.kinetic);
  if (law.drop != 0.0)
    g += stribeck *
         (2.0 - ((2.0 * std::abs(speed.mean) + s_swing) * s_swing / (law.stribeck_speed * law.stribeck_speed)).exp());
  const PerEllipse most = (g > 0.0).select((std::abs(speed.mean) + s_swing) * (1.0 + law.stiffness * z_most / g),
                                           PerEllipse::Constant(std::numeric_limits<double>::infinity()));
  const double rest = std::exp(log_remainder(most.log())) + by_speed * between + most_decay * off;
  if (!std::isfinite(rest)) {
    out.force = rest;
    return out;
  }

  const double of_force = nodes_.lebesgue * left + law.stiffness * eighth_degree(z_begin, z) + law.damping * rest +
                          law.viscous * (eighth_degree(s_begin, s) + between) + by_bristle * off;
  out.force = of_force + by_bristle * rest * (decay * h > 1.0 ? 1.0 / decay : h);
  // μ grows no faster than e^{ηt}, (η − a)(η + κ) = b: a by the speed itself, b by the bristle it moves.
  const double a = reach * (law.damping * by_speed + law.viscous), b = reach * by_bristle * by_speed;
  out.growth = 0.5 * (a - decay + std::sqrt((a + decay) * (a + decay) + 4.0 * b));
  return out;
}

}  // namespace slipmode::dynamics
