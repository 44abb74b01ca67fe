#include "bench/shaken_problem.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/fem/modes.hpp>

#include <cmath>

namespace slipmode::bench {
namespace {

std::vector<double> numbers_of(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

/// D, its diagonal alone where the rest is rounding.
std::vector<double> damping_of(const Eigen::MatrixXd& D) {
  constexpr double kRounding = 1e-9;
  const Eigen::VectorXd diagonal = D.diagonal();
  const Eigen::MatrixXd rest = D - Eigen::MatrixXd(diagonal.asDiagonal());
  if (rest.norm() <= kRounding * D.norm()) return numbers_of(diagonal);
  std::vector<double> rows;
  for (Eigen::Index i = 0; i < D.rows(); ++i) {
    for (Eigen::Index j = 0; j < D.cols(); ++j) rows.push_back(D(i, j));
  }
  return rows;
}

}  // namespace

ShakenCoordinates::ShakenCoordinates(const dynamics::HybridSystem& system) {
  const friction::Shaker* shaker = system.drive().shaker();
  const bool compliant =
      system.contacts().size() == 1 && friction::kind(system.contacts().front().law) == friction::LawKind::kCompliant;
  if (shaker == nullptr || !compliant || system.contacts().front().normal_load.oscillator) {
    throw InvalidInput("the peers integrate one compliant contact on a shaker, its normal load without an oscillator");
  }
  const friction::Contact& contact = system.contacts().front();
  const double mu_s = friction::static_coefficient(contact.law), mu_k = friction::limit_coefficient(contact.law);
  const auto coefficient = [&](double mu, double sign) {
    return friction::effective_coefficient(mu, contact.tilt, sign);
  };
  const fem::Modes modes = fem::natural_modes(system.structure());
  to_eta_ = fem::multiply(system.structure().M(), modes.shapes).transpose();
  const Eigen::MatrixXd D = modes.shapes.transpose() * fem::multiply(system.structure().C(), modes.shapes);
  const Eigen::VectorXd load = system.load().size() > 0 ? Eigen::VectorXd(modes.shapes.transpose() * system.load())
                                                        : Eigen::VectorXd::Zero(system.size());
  problem_ = {.n = static_cast<int>(system.size()),
              .omega = numbers_of(modes.omega),
              .damping = damping_of(D),
              .load = numbers_of(load),
              .direction = numbers_of(modes.shapes.transpose() * contact.direction),
              .offset = contact.offset,
              .stiffness = friction::spring_stiffness(contact.law),
              .static_plus = coefficient(mu_s, 1.0),
              .static_minus = coefficient(mu_s, -1.0),
              .kinetic_plus = coefficient(mu_k, 1.0),
              .kinetic_minus = coefficient(mu_k, -1.0),
              .load_constant = contact.normal_load.constant,
              .load_slope = contact.normal_load.slope,
              .amplitude = shaker->amplitude,
              .drive_omega = shaker->omega(),
              .phase = shaker->phase};
}

ShakenPoint ShakenCoordinates::point(const dynamics::State& state) const {
  const Eigen::VectorXd eta = to_eta_ * state.q, rate = to_eta_ * state.v;
  ShakenPoint point;
  point.time = state.time;
  for (int i = 0; i < problem_.n; ++i) point.y.push_back(problem_.omega[i] * eta[i]);
  point.y.insert(point.y.end(), rate.begin(), rate.end());
  if (!state.modes.empty()) point.mode = static_cast<int>(state.modes.front());
  if (state.internal.size() > 0) point.stretch = state.internal[0];
  return point;
}

double energy_norm(const std::vector<double>& y) {
  double sum = 0.0;
  for (const double value : y) sum += value * value;
  return std::sqrt(sum);
}

double energy_distance(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> difference(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) difference[i] = x[i] - y[i];
  return energy_norm(difference);
}

}  // namespace slipmode::bench
