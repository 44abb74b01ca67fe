// How far the true force of a law may be from the computed one, by bounds on its slopes: docs/theory/flow.md,
// section 4.
#include "dynamics/internal/collocation_flow.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

double largest(const BernsteinPolynomial& p) { return std::max(most(p), -least(p)); }

}  // namespace

bool CollocationFlow::by_bounds(int c) const {
  const ContactForces& law = laws()[static_cast<std::size_t>(c)];
  return law.kind == LawKind::kSmooth || (law.characteristic != nullptr && !held(point_.modes, c));
}

CollocationFlow::BoundedDefect CollocationFlow::bounded_defect(int c) const {
  // Of a function whose second derivative is bounded, polynomials of degree 7 leave (π/2)²/(8·7) of it, on [−1, 1]
  // (Jackson's theorem), and their interpolation 1 + Λ times that.
  constexpr double kJackson = std::numbers::pi * std::numbers::pi / (4.0 * 8.0 * 7.0 * 4.0);
  const auto i = static_cast<std::size_t>(c);
  const ContactForces& law = laws()[i];
  const double sign = law.sticks() ? sign_of(point_.modes[i]) : 1.0;
  const RadauTables::Vector8 speed =
      sign * (drive_nodes_.segment<kNodes>(kNodes * c) - velocity_.segment<kNodes>(kNodes * c));
  const BernsteinPolynomial p =
      interpolant(sign * (drive_velocity(begin_, 0.0) - resolver_.contact_velocity(c, x_begin_.data())), speed);
  const BernsteinPolynomial rate = derivative(p), bend = derivative(rate);
  double left = 0.0;
  for (int j = 0; j < kNodes; ++j)
    left = std::max(left, std::abs(forces_(kNodes * c + j) - law.continued(sign, sign * speed(j))));
  const double between = nodes_.remainder[0] * ninth_(c), slowest = least(p), fastest = most(p),
               fastest_rate = largest(rate);
  BoundedDefect out{.room = std::max(0.5 * (std::max(slowest, -fastest) - between), fastest - slowest)};
  const friction::LawBounds along = *law.bounds(slowest, fastest),
                            around = *law.bounds(slowest - between - out.room, fastest + between + out.room);
  out.rate = around.slope * fastest_rate;
  out.growth = around.slope;
  out.force =
      nodes_.lebesgue * left + around.slope * between +
      (1.0 + nodes_.lebesgue) * kJackson * (along.curve * fastest_rate * fastest_rate + along.slope * largest(bend));
  return out;
}

}  // namespace slipmode::dynamics
