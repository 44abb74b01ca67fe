#include "trade/internal/horizon.hpp"

#include <slipmode/diagnostics/model.hpp>

#include <cmath>

namespace slipmode::trade {

namespace {

/// Records from several starts, side by side.
struct Records {
  Eigen::MatrixXd q, v;     ///< of which energies are made
  Eigen::MatrixXd reading;  ///< compared instead of q and v on a beam
  const fem::Structure* structure = nullptr;

  /// Energy at every instant, about a displacement [T].
  [[nodiscard]] Eigen::RowVectorXd energies(const Eigen::VectorXd& origin) const {
    const Eigen::MatrixXd x = q.colwise() - origin;
    return 0.5 * (v.cwiseProduct(fem::multiply(structure->M(), v)) + x.cwiseProduct(fem::multiply(structure->K(), x)))
                     .colwise()
                     .sum();
  }
};

/// Displacements in full coordinates, where the two cases share them.
Eigen::MatrixXd lifted(const Case& model, const Eigen::MatrixXd& q, bool displacements) {
  if (!model.basis) return q;
  Eigen::MatrixXd full = model.basis->vectors * q;
  if (displacements && model.basis->mean.size() > 0) full.colwise() += model.basis->mean;
  return full;
}

/// All starts' records of one case, `columns` samples each.
Records run_all(const Case& model, const std::vector<dynamics::State>& starts, const Schedule& schedule,
                Eigen::Index columns, const StopFlag* stop) {
  const bool own = model.beam != nullptr;
  const fem::Structure& structure = own ? model.model.system.structure() : model.full.structure();
  const auto all = columns * static_cast<Eigen::Index>(starts.size());
  Records records{.q = Eigen::MatrixXd(structure.size(), all),
                  .v = Eigen::MatrixXd(structure.size(), all),
                  .reading = Eigen::MatrixXd(1, all),
                  .structure = &structure};
  Eigen::Index at = 0;
  for (const dynamics::State& start : starts) {
    if (stop != nullptr && stop->load()) throw Interrupted();
    const dynamics::Trajectory run = dynamics::simulate(
        model.model.system, start,
        {.duration = schedule.horizon, .sample = schedule.horizon_sample, .keep_events = false, .flow = model.flow});
    records.q.middleCols(at, columns) = own ? run.q.leftCols(columns) : lifted(model, run.q.leftCols(columns), true);
    records.v.middleCols(at, columns) = own ? run.v.leftCols(columns) : lifted(model, run.v.leftCols(columns), false);
    records.reading.middleCols(at, columns) = model.model.readings.of(run.q.leftCols(columns));
    at += columns;
  }
  return records;
}

/// Sums over the columns of each start.
Eigen::VectorXd per_start(const Eigen::RowVectorXd& values, Eigen::Index columns) {
  return values.reshaped(columns, values.size() / columns).colwise().sum().transpose();
}

double standard_error(const Eigen::VectorXd& values) {
  const auto n = static_cast<double>(values.size());
  if (n < 2.0) return 0.0;
  return std::sqrt((values.array() - values.mean()).square().sum() / (n * (n - 1.0)));
}

Eigen::RowVectorXd squares(const Eigen::MatrixXd& values) { return values.colwise().squaredNorm(); }

HorizonDeviation compared(const Records& a, const Records& b, bool by_reading, Eigen::Index columns) {
  const Eigen::VectorXd origin = a.q.rowwise().mean();
  Eigen::RowVectorXd gap, size;
  if (by_reading) {
    gap = squares(a.reading - b.reading);
    size = squares(a.reading.array() - a.reading.mean());
  } else {
    gap = squares(a.q - b.q) + squares(a.v - b.v);
    size = squares(a.q.colwise() - origin) + squares(a.v);
  }
  const Eigen::RowVectorXd E_a = a.energies(origin);
  const Eigen::RowVectorXd E_b = b.energies(by_reading ? Eigen::VectorXd(b.q.rowwise().mean()) : origin);

  const Eigen::VectorXd shares = per_start(gap, columns) * (static_cast<double>(gap.size() / columns) / size.sum());
  const Eigen::VectorXd gains = per_start(E_b - E_a, columns) / (static_cast<double>(columns) * E_a.mean());
  HorizonDeviation out;
  out.dX = 100.0 * std::sqrt(shares.mean());
  out.dE = 100.0 * std::abs(gains.mean());
  if (out.dX > 0.0) out.dX_scatter = 100.0 * standard_error(shares) / (2.0 * std::sqrt(shares.mean()));
  out.dE_scatter = 100.0 * standard_error(gains);
  return out;
}

}  // namespace

std::vector<dynamics::State> states_of(const Case& reference, const dynamics::State& start, int count, double gap,
                                       const StopFlag* stop) {
  std::vector<dynamics::State> states = {start};
  const dynamics::SimulateOptions run{.duration = gap, .keep_events = false, .flow = reference.flow};
  while (states.size() < static_cast<std::size_t>(count)) {
    if (stop != nullptr && stop->load()) throw Interrupted();
    states.push_back(dynamics::simulate(reference.model.system, states.back(), run).final_state);
  }
  return states;
}

HorizonDeviation horizon_deviation(const Case& reference, const Case& candidate,
                                   const std::vector<dynamics::State>& starts, const Schedule& schedule,
                                   HorizonStarts from, const StopFlag* stop) {
  std::vector<dynamics::State> own, shared;
  for (const dynamics::State& start : starts) {
    own.push_back(handed_on(reference, candidate, start));
    shared.push_back(from == HorizonStarts::kReference ? start : handed_on(candidate, reference, own.back()));
    if (shared.back().internal.size() == 0) shared.back().internal = start.internal;
  }
  const auto columns = static_cast<Eigen::Index>(std::llround(schedule.horizon / schedule.horizon_sample));
  const Records a = run_all(reference, shared, schedule, columns, stop);
  const Records b = run_all(candidate, own, schedule, columns, stop);
  return compared(a, b, reference.beam != nullptr, columns);
}

}  // namespace slipmode::trade
