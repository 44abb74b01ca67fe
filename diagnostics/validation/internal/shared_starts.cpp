#include "diagnostics/validation/internal/shared_starts.hpp"

#include <slipmode/rom/reduce.hpp>

#include <cmath>
#include <utility>

namespace slipmode::diagnostics {

namespace {

Record appended(Record record, const Record& next) {
  if (record.q.cols() == 0) return next;
  const Eigen::Index columns = record.q.cols();
  record.q.conservativeResize(Eigen::NoChange, columns + next.q.cols());
  record.v.conservativeResize(Eigen::NoChange, columns + next.v.cols());
  record.q.rightCols(next.q.cols()) = next.q;
  record.v.rightCols(next.v.cols()) = next.v;
  return record;
}

}  // namespace

std::vector<dynamics::State> states_along(const dynamics::HybridSystem& system, const dynamics::State& start, int count,
                                          double gap, const dynamics::FlowOptions& flow) {
  std::vector<dynamics::State> states = {start};
  const dynamics::SimulateOptions run{.duration = gap, .keep_events = false, .flow = flow};
  while (states.size() < static_cast<std::size_t>(count)) {
    states.push_back(dynamics::simulate(system, states.back(), run).final_state);
  }
  return states;
}

Deviation deviation_up_to_horizon(const fem::Structure& structure, const Model& full, const Model& reduced,
                                  double parameter, const std::vector<dynamics::State>& starts, double horizon,
                                  double sample, const dynamics::FlowOptions& flow) {
  Record all_full;
  Record all_reduced;
  for (const dynamics::State& state : starts) {
    const SharedRun run = run_shared(full, reduced, parameter, rom::restrict_state(structure, *reduced.basis, state),
                                     horizon, sample, flow);
    all_full = appended(std::move(all_full), run.full);
    all_reduced = appended(std::move(all_reduced), run.reduced);
  }
  return deviation(structure, all_full, all_reduced);
}

double distance_to_basis(const fem::Structure& structure, const pod::Basis& basis,
                         const std::vector<dynamics::State>& states) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(structure.size());
  for (const dynamics::State& state : states) mean += state.q / double(states.size());
  double lost = 0.0;
  double size = 0.0;
  for (const dynamics::State& state : states) {
    const dynamics::State back = rom::lift(basis, rom::restrict_state(structure, basis, state));
    lost += (state.q - back.q).squaredNorm() + (state.v - back.v).squaredNorm();
    size += (state.q - mean).squaredNorm() + state.v.squaredNorm();
  }
  return size > 0.0 ? 100.0 * std::sqrt(lost / size) : 0.0;
}

}  // namespace slipmode::diagnostics
