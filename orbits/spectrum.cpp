#include <slipmode/orbits/spectrum.hpp>

#include <slipmode/core/errors.hpp>

#include <numbers>
#include <string>

namespace slipmode::orbits {

Spectrum orbit_spectrum(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, int order,
                        const Eigen::MatrixXd& rows) {
  if (order < 0) throw InvalidInput("a spectrum has orders from 0 on; found " + std::to_string(order));
  const OrbitSeries series(system, orbit, rows);
  const Eigen::Index count = 3 * series.contacts() + 2 * series.rows();
  Eigen::MatrixXd cosine(order + 1, count), sine(order + 1, count);
  for (int k = 0; k <= order; ++k) {
    const Eigen::VectorXcd c = (k == 0 ? 1.0 : 2.0) * series.coefficient(k);
    cosine.row(k) = c.real();
    sine.row(k) = k == 0 ? Eigen::VectorXd::Zero(count).eval() : Eigen::VectorXd(-c.imag());
  }
  Spectrum spectrum;
  spectrum.omega = 2.0 * std::numbers::pi / orbit.period;
  spectrum.defect = series.defect();
  Eigen::Index next = 0;
  const auto take = [&](std::vector<Harmonics>& out, Eigen::Index many) {
    for (Eigen::Index c = 0; c < many; ++c, ++next) out.push_back({cosine.col(next), sine.col(next)});
  };
  for (auto* of_contacts : {&spectrum.displacement, &spectrum.velocity, &spectrum.force})
    take(*of_contacts, series.contacts());
  for (auto* of_rows : {&spectrum.row_displacement, &spectrum.row_velocity}) take(*of_rows, series.rows());
  return spectrum;
}

}  // namespace slipmode::orbits
