#include <slipmode/diagnostics/validation/compare.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/median.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/diagnostics/series/point_sets.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slipmode::diagnostics {

namespace {

/// The run from `start`, lifted: column k at k·sample.
Record simulate_record(const Model& model, double parameter, const dynamics::State& start, double duration,
                       double sample, const dynamics::FlowOptions& flow) {
  const dynamics::Trajectory run = dynamics::simulate(
      model.system(parameter), start, {.duration = duration, .sample = sample, .keep_events = false, .flow = flow});
  if (!model.basis) return {.q = run.q, .v = run.v};
  const pod::Basis& basis = *model.basis;
  Record record{.q = basis.vectors * run.q, .v = basis.vectors * run.v};
  if (basis.mean.size() > 0) record.q.colwise() += basis.mean;
  return record;
}

/// Energy about the point x = 0 at every instant [T].
Eigen::VectorXd energies(const fem::Structure& structure, const Eigen::MatrixXd& x, const Eigen::MatrixXd& v) {
  return 0.5 * (v.cwiseProduct(fem::multiply(structure.M(), v)) + x.cwiseProduct(fem::multiply(structure.K(), x)))
                   .colwise()
                   .sum()
                   .transpose();
}

std::vector<double> displacements_of(const Settled& settled, int contact) {
  std::vector<double> displacements;
  for (const SlipState& slip : settled.slips) {
    if (slip.contact == contact) displacements.push_back(slip.displacement);
  }
  return displacements;
}

double mean(const std::vector<double>& values) {
  if (values.empty()) return kNone;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

Deviation deviation(const fem::Structure& structure, const Record& full, const Record& reduced) {
  const bool same = full.q.rows() == reduced.q.rows() && full.q.cols() == reduced.q.cols() &&
                    full.v.rows() == full.q.rows() && full.v.cols() == full.q.cols() &&
                    reduced.v.rows() == full.q.rows() && reduced.v.cols() == full.q.cols();
  if (!same || full.q.cols() == 0 || full.q.rows() != structure.size()) {
    throw InvalidInput(
        fmt::format("deviation: expected two records of {} rows and the same number of columns, found "
                    "{} x {} and {} x {}",
                    structure.size(), full.q.rows(), full.q.cols(), reduced.q.rows(), reduced.q.cols()));
  }
  const Eigen::VectorXd origin = full.q.rowwise().mean();
  const Eigen::MatrixXd x_full = full.q.colwise() - origin;
  const Eigen::MatrixXd x_reduced = reduced.q.colwise() - origin;
  const double size = x_full.squaredNorm() + full.v.squaredNorm();
  const double rounding = 1e-12 * origin.norm();
  if (!(size > rounding * rounding * static_cast<double>(full.q.cols()))) {
    throw InvalidInput("deviation: expected a full record that moves, found one at rest to rounding");
  }
  const Eigen::VectorXd E_full = energies(structure, x_full, full.v);
  const Eigen::VectorXd E_reduced = energies(structure, x_reduced, reduced.v);

  Deviation result;
  const double gap = (x_full - x_reduced).squaredNorm() + (full.v - reduced.v).squaredNorm();
  result.dX = 100.0 * std::sqrt(gap / size);
  result.energy_full = E_full.mean();
  result.energy_reduced = E_reduced.mean();
  result.dE = 100.0 * std::abs(result.energy_full - result.energy_reduced) / result.energy_full;
  const double rms = std::sqrt((E_full - E_reduced).squaredNorm() / static_cast<double>(E_full.size()));
  result.dE_pointwise = 100.0 * rms / result.energy_full;
  return result;
}

Record sample_orbit(const Model& model, double parameter, const dynamics::State& start, double T, Eigen::Index samples,
                    const dynamics::FlowOptions& flow) {
  if (!(T > 0.0) || samples < 1) {
    throw InvalidInput(fmt::format("orbit samples: expected T > 0 and samples >= 1, found {} and {}", T, samples));
  }
  Record record = simulate_record(model, parameter, start, T, T / static_cast<double>(samples), flow);
  const Eigen::Index columns = std::min(samples, record.q.cols());
  record.q.conservativeResize(Eigen::NoChange, columns);
  record.v.conservativeResize(Eigen::NoChange, columns);
  return record;
}

OrbitComparison compare_orbits(const fem::Structure& structure, const Model& full, const Model& reduced,
                               double parameter, const Orbit& full_orbit, const Orbit& reduced_orbit,
                               Eigen::Index samples, const dynamics::FlowOptions& flow) {
  OrbitComparison result{.full = full_orbit, .reduced = reduced_orbit};
  result.same_period = full_orbit.period == reduced_orbit.period;
  result.T_difference = 100.0 * (reduced_orbit.T - full_orbit.T) / full_orbit.T;
  if (!result.same_period) return result;
  const Record reference = sample_orbit(full, parameter, full_orbit.states.front(), full_orbit.T, samples, flow);
  for (std::size_t k = 0; k < reduced_orbit.states.size(); ++k) {
    const Record record = sample_orbit(reduced, parameter, reduced_orbit.states[k], reduced_orbit.T, samples, flow);
    const Deviation found = deviation(structure, reference, record);
    if (k > 0 && found.dX >= result.deviation.dX) continue;
    result.deviation = found;
    result.alignment = static_cast<int>(k);
  }
  return result;
}

SharedRun run_shared(const Model& full, const Model& reduced, double parameter, const dynamics::State& start,
                     double horizon, double sample, const dynamics::FlowOptions& flow) {
  if (!(horizon > 0.0) || !(sample > 0.0)) {
    throw InvalidInput(
        fmt::format("horizon comparison: expected horizon > 0 and sample > 0, found {} and {}", horizon, sample));
  }
  const dynamics::State begin = dynamics::handed_on(reduced.system(parameter), start);
  return {.full = simulate_record(full, parameter, lifted(reduced, begin), horizon, sample, flow),
          .reduced = simulate_record(reduced, parameter, begin, horizon, sample, flow)};
}

AttractorDistance attractor_distance(const Settled& full, const Settled& reduced) {
  AttractorDistance distance{.wasserstein = kNone, .hausdorff = kNone};
  const std::vector<double> a = displacements_of(full, full.period.contact);
  const std::vector<double> b = displacements_of(reduced, full.period.contact);
  if (!a.empty() && !b.empty()) {
    distance.wasserstein = wasserstein(a, b);
    distance.hausdorff = hausdorff(a, b);
  }
  distance.mean_energy = reduced.mean_energy - full.mean_energy;
  distance.mean_energy_percent = 100.0 * distance.mean_energy / full.mean_energy;
  distance.stick_fraction = reduced.stick_fraction - full.stick_fraction;
  distance.slip_rate = reduced.slip_rate - full.slip_rate;
  return distance;
}

BifurcationComparison compare_sweeps(const std::vector<SweepPoint>& full, const std::vector<SweepPoint>& reduced) {
  if (full.size() != reduced.size()) {
    throw InvalidInput(
        fmt::format("sweep comparison: expected as many points in both, found {} and {}", full.size(), reduced.size()));
  }
  BifurcationComparison result;
  std::vector<double> wassersteins;
  std::vector<double> hausdorffs;
  for (std::size_t i = 0; i < full.size(); ++i) {
    if (full[i].parameter != reduced[i].parameter) {
      throw InvalidInput(
          fmt::format("sweep comparison: expected the same values in the same order, found {} and {} at "
                      "place {}",
                      full[i].parameter, reduced[i].parameter, i));
    }
    if (!full[i].ok() || !reduced[i].ok()) {
      ++result.failed;
      continue;
    }
    ++result.values;
    const PeriodResult& a = full[i].settled.period;
    const PeriodResult& b = reduced[i].settled.period;
    if (a.motion != Motion::kUndecided && b.motion != Motion::kUndecided) {
      ++result.decided;
      result.same_motion += a.motion == b.motion ? 1.0 : 0.0;
      result.same_period += a.motion == b.motion && a.period == b.period ? 1.0 : 0.0;
    }
    result.periodic_full += a.motion == Motion::kPeriodic ? 1.0 : 0.0;
    result.periodic_reduced += b.motion == Motion::kPeriodic ? 1.0 : 0.0;
    const AttractorDistance distance = attractor_distance(full[i].settled, reduced[i].settled);
    if (std::isnan(distance.wasserstein)) continue;
    wassersteins.push_back(distance.wasserstein);
    hausdorffs.push_back(distance.hausdorff);
  }
  for (double* share : {&result.same_motion, &result.same_period}) {
    *share = result.decided > 0 ? *share / static_cast<double>(result.decided) : kNone;
  }
  for (double* share : {&result.periodic_full, &result.periodic_reduced}) {
    if (result.values > 0) *share /= static_cast<double>(result.values);
  }
  result.mean_wasserstein = mean(wassersteins);
  result.median_wasserstein = median(wassersteins);
  result.mean_hausdorff = mean(hausdorffs);
  return result;
}

}  // namespace slipmode::diagnostics
