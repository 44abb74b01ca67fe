#pragma once

#include <slipmode/orbits/periodic_orbit.hpp>

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace slipmode::orbits {

/// One period of an orbit as functions of time: chosen rows rᵀq and rᵀq̇, and every contact's displacement, velocity and
/// force. Each stay between events is cut into panels on which all of them are Legendre series of degree 15 to
/// rounding, whatever the law: from there values, Fourier coefficients of any order and extremes follow in closed form.
///
/// Quantities, in this order: displacements of the contacts, velocities of the contacts, forces of the contacts (nc
/// each), displacements of the rows, velocities of the rows (nr each). Source: docs/theory/harmonic-balance.md,
/// section 1.
class OrbitSeries {
 public:
  static constexpr int kTerms = 16;

  /// @param rows  r as columns [n x nr]; may have none
  /// @throws InvalidInput      for rows of wrong size
  /// @throws NumericalFailure  when panels of a 16,384th of the period do not suffice
  OrbitSeries(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, const Eigen::MatrixXd& rows = {});

  [[nodiscard]] Eigen::Index contacts() const { return contacts_; }
  [[nodiscard]] Eigen::Index rows() const { return rows_; }
  [[nodiscard]] double start() const { return start_; }    ///< of the orbit, within the first period [s]
  [[nodiscard]] double period() const { return period_; }  ///< [s]
  /// The largest share of a quantity's size that the last two terms of a panel still have: what the series leave out is
  /// below that. Displacements and velocities that are rounding of the whole motion are left out.
  [[nodiscard]] double defect() const { return defect_; }

  /// All quantities at a time, any number of periods away. At an event the later panel's.
  [[nodiscard]] Eigen::VectorXd at(double time) const;
  /// (1/T)∫ y e^{−ikΩt} dt of all quantities, Ω = 2π/T, t the flow's own time: y = Σ_k of these e^{ikΩt} over all k.
  /// @param order  k ≥ 0
  [[nodiscard]] Eigen::VectorXcd coefficient(int order) const;

  /// A stretch of time and the coefficients of its Legendre polynomials, one row per quantity [· x kTerms].
  struct Panel {
    double middle = 0.0, half = 0.0;  ///< [s]
    Eigen::MatrixXd terms;
  };
  [[nodiscard]] const std::vector<Panel>& panels() const { return panels_; }

 private:
  Eigen::Index contacts_ = 0, rows_ = 0;
  double start_ = 0.0, period_ = 0.0, defect_ = 0.0;
  std::vector<Panel> panels_;
};

/// The size of an orbit's whole motion, or of what the contacts' forces would move where all is at rest [m].
[[nodiscard]] double size_of_motion(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit);

}  // namespace slipmode::orbits
