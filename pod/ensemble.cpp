#include <slipmode/pod/ensemble.hpp>

#include <slipmode/core/errors.hpp>
#include "pod/internal/assemble.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::pod {

namespace {

void check_runs(const Ensemble& ensemble) {
  Eigen::Index previous = -1;
  for (const Eigen::Index begin : ensemble.run_begin) {
    const bool ascends = previous < 0 ? begin == 0 : begin > previous;
    if (!ascends || begin >= ensemble.snapshots.cols()) {
      throw InvalidInput(
          fmt::format("ensemble: run_begin must start with 0 and ascend below the {} snapshots, found {} after {}",
                      ensemble.snapshots.cols(), begin, previous));
    }
    previous = begin;
  }
}

}  // namespace

void check_finite(const Eigen::MatrixXd& snapshots, Eigen::Index first) {
  for (Eigen::Index j = 0; j < snapshots.cols(); ++j) {
    if (snapshots.col(j).allFinite()) continue;
    for (Eigen::Index i = 0; i < snapshots.rows(); ++i) {
      if (!std::isfinite(snapshots(i, j))) {
        throw InvalidInput(fmt::format(
            "ensemble: snapshot {} (from 1), dof {} (from 1) is {}; every displacement must be finite. Remove the run "
            "or the instant it comes from",
            first + j + 1, i + 1, snapshots(i, j)));
      }
    }
  }
}

void check_counts(Eigen::Index dofs, Eigen::Index snapshots) {
  if (dofs < 1) throw InvalidInput("ensemble: no degrees of freedom (0 rows); expected at least 1");
  if (snapshots < 2) {
    throw InvalidInput(fmt::format(
        "ensemble: {} snapshot(s); expected at least 2. Sample more often or longer, or add runs", snapshots));
  }
}

void validate(const Ensemble& ensemble) {
  check_counts(ensemble.snapshots.rows(), ensemble.snapshots.cols());
  check_runs(ensemble);
  check_finite(ensemble.snapshots, 0);
}

Ensemble join(std::span<const Eigen::MatrixXd> runs) {
  if (runs.empty()) throw InvalidInput("ensemble: no runs to join");
  Ensemble joined;
  Eigen::Index columns = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (runs[r].rows() != runs[0].rows() || runs[r].cols() < 1) {
      throw InvalidInput(
          fmt::format("ensemble: run {} (from 1) is {} x {}; expected {} rows, as in the first run, and at "
                      "least one snapshot",
                      r + 1, runs[r].rows(), runs[r].cols(), runs[0].rows()));
    }
    joined.run_begin.push_back(columns);
    columns += runs[r].cols();
  }
  joined.snapshots.resize(runs[0].rows(), columns);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    joined.snapshots.middleCols(joined.run_begin[r], runs[r].cols()) = runs[r];
  }
  return joined;
}

}  // namespace slipmode::pod
