#pragma once

#include <slipmode/diagnostics/attractors/settle.hpp>
#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/diagnostics/model.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::diagnostics {

/// Displacements and velocities in full coordinates, one column per instant [n x T].
struct Record {
  Eigen::MatrixXd q, v;
};

/// S4's two deviations, as averages over a record. Displacements are measured from the full record's mean (S4 measures
/// from the static deflection, about which it takes the mean to be zero): x = q − ⟨q_full⟩.
/// dX = 100 sqrt(⟨Σ (x_f − x_r)² + (ẋ_f − ẋ_r)²⟩ / ⟨Σ x_f² + ẋ_f²⟩), S4 (3.37);
/// dE = 100 |⟨E_f⟩ − ⟨E_r⟩| / ⟨E_f⟩ with E = ½ ẋᵀMẋ + ½ xᵀKx, S4 (3.36) and (3.35).
struct Deviation {
  double dX = 0.0;              ///< [%]
  double dE = 0.0;              ///< [%]
  double dE_pointwise = 0.0;    ///< 100 sqrt(⟨(E_f − E_r)²⟩) / ⟨E_f⟩: also sees a shift in time [%]
  double energy_full = 0.0;     ///< ⟨E_f⟩ [J]
  double energy_reduced = 0.0;  ///< ⟨E_r⟩ [J]
};

/// @throws InvalidInput  if sizes differ, a record is empty, or the full record does not move
[[nodiscard]] Deviation deviation(const fem::Structure& structure, const Record& full, const Record& reduced);

/// `samples` equally spaced instants of one period from `start` (the end of the period not included), lifted.
[[nodiscard]] Record sample_orbit(const Model& model, double parameter, const dynamics::State& start, double T,
                                  Eigen::Index samples, const dynamics::FlowOptions& flow = {});

/// Full against reduced on a periodic orbit of each.
struct OrbitComparison {
  Orbit full = {};
  Orbit reduced = {};
  bool same_period = false;   ///< same number of slips; without it, `deviation` is not filled
  Deviation deviation = {};   ///< in phase, each orbit sampled over its own period
  int alignment = 0;          ///< the reduced orbit's slip laid on the full orbit's first one: the one of least dX
  double T_difference = 0.0;  ///< 100 (T_r − T_f)/T_f [%]
};

/// @param structure  of the full model
[[nodiscard]] OrbitComparison compare_orbits(const fem::Structure& structure, const Model& full, const Model& reduced,
                                             double parameter, const Orbit& full_orbit, const Orbit& reduced_orbit,
                                             Eigen::Index samples = 2048, const dynamics::FlowOptions& flow = {});

/// Full and reduced from one initial state, at the same instants.
struct SharedRun {
  Record full;
  Record reduced;
};

/// Full against reduced from one initial state up to a horizon; deviation(…) of the two records is S4's measure. For a
/// chaotic motion nothing beyond a few 1/λ₁ means anything: say the horizon with the number.
/// @param start  in the reduced model's coordinates; the full model starts from it lifted
/// @throws InvalidInput  for horizon ≤ 0, sample ≤ 0
[[nodiscard]] SharedRun run_shared(const Model& full, const Model& reduced, double parameter,
                                   const dynamics::State& start, double horizon, double sample,
                                   const dynamics::FlowOptions& flow = {});

/// Full against reduced as attractors, whatever their motion.
struct AttractorDistance {
  double wasserstein = 0.0;          ///< of the slip states of the full model's section contact [m]
  double hausdorff = 0.0;            ///< [m]
  double mean_energy = 0.0;          ///< difference reduced − full [J]
  double mean_energy_percent = 0.0;  ///< of the full model's [%]
  double stick_fraction = 0.0;       ///< difference reduced − full
  double slip_rate = 0.0;            ///< difference reduced − full [1/s]
};

/// NaN where one of them has no slip states. Energies are taken as they stand in `mean_energy`: add each model's
/// energy_offset first (a sweep has done so).
[[nodiscard]] AttractorDistance attractor_distance(const Settled& full, const Settled& reduced);

/// Two bifurcation diagrams, value by value.
struct BifurcationComparison {
  std::size_t values = 0;      ///< where both models gave a result
  std::size_t failed = 0;      ///< where at least one did not
  std::size_t decided = 0;     ///< where neither motion is undecided: an undecided one beside another is no agreement
  double same_motion = 0.0;    ///< share of the values decided with the same kind of motion; NaN: none is decided
  double same_period = 0.0;    ///< the same with the same kind and, if periodic, the same period
  double periodic_full = 0.0;  ///< share periodic in the full model
  double periodic_reduced = 0.0;
  double mean_wasserstein = 0.0;    ///< mean over the values where both have slip states [m]
  double median_wasserstein = 0.0;  ///< [m]
  double mean_hausdorff = 0.0;      ///< [m]
};

/// @throws InvalidInput  if the points are not of the same values in the same order
[[nodiscard]] BifurcationComparison compare_sweeps(const std::vector<SweepPoint>& full,
                                                   const std::vector<SweepPoint>& reduced);

}  // namespace slipmode::diagnostics
