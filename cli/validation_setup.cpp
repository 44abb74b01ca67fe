#include "cli/validation_setup.hpp"

#include <slipmode/core/none.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/rom/reduce.hpp>
#include "cli/steps.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {
namespace {

/// A small ensemble with the mean-free second moments of the one a POD was made of: ±σ_i φ_i.
pod::Ensemble moments(const pod::PodResult& result) {
  const Eigen::MatrixXd half = result.basis.vectors * result.singular_values.head(result.basis.modes()).asDiagonal();
  Eigen::MatrixXd snapshots(half.rows(), 2 * half.cols());
  snapshots << half, -half;
  return {.snapshots = snapshots, .run_begin = {0}};
}

diagnostics::Candidate reduced_candidate(const results::StoreReader& store, const std::string& group, Eigen::Index n) {
  const pod::Basis basis = results::load_basis(store, group, n);
  const bool known = basis.energy.size() == basis.modes();
  return {.name = basis.kind == pod::BasisKind::kPom   ? "POM"
                  : basis.kind == pod::BasisKind::kLnm ? "LNM"
                                                       : "user",
          .basis = basis,
          .captured = known ? cumulative(basis.energy) : Eigen::VectorXd::Constant(basis.modes(), kNone)};
}

}  // namespace

diagnostics::SettleOptions settle_options(const scene::Scene& scene) {
  const auto& spec = scene.validation;
  return {.transient = spec.transient,
          .block = spec.block,
          .limit = spec.limit,
          .period = {.tolerance = spec.period_tolerance, .max_period = spec.max_period},
          .flow = scene.flow};
}

diagnostics::SettleOptions sweep_settle_options(const scene::Scene& scene) {
  diagnostics::SettleOptions options = settle_options(scene);
  options.limit = scene.validation.sweep_limit;
  options.block = std::min(options.block, options.limit);
  options.patience = 1.0;
  options.flow.audit = false;
  return options;
}

std::vector<diagnostics::Candidate> pom_and_lnm(const scene::Scene& scene, const fem::Structure& structure,
                                                const pod::PodResult& result) {
  pod::Basis lnm = rom::lnm_basis(structure, structure.size());
  lnm.mean = result.basis.mean;
  std::vector<diagnostics::Candidate> candidates;
  candidates.push_back({.name = "POM", .basis = result.basis, .captured = cumulative(result.shares)});
  candidates.push_back({.name = "LNM", .basis = lnm, .captured = pod::captured_energy(moments(result), lnm)});
  if (scene.reduction.basis == scene::BasisChoice::kLnm) std::swap(candidates[0], candidates[1]);
  return candidates;
}

std::vector<diagnostics::Candidate> load_candidates(const scene::Scene& scene, const fem::Structure& structure,
                                                    const std::string& file) {
  const results::StoreReader store(file);
  if (store.has(results::kReducedGroup)) {
    return {reduced_candidate(store, std::string(results::kReducedGroup) + "/basis", structure.size())};
  }
  if (store.has(results::kPodGroup)) {
    return pom_and_lnm(scene, structure, results::load_pod(store, results::kPodGroup, structure.size()));
  }
  if (store.has(results::kBasisGroup)) return {reduced_candidate(store, results::kBasisGroup, structure.size())};
  const pod::Ensemble ensemble = load_snapshots(store);
  if (ensemble.snapshots.rows() != structure.size()) {
    store.fail(results::kEnsembleGroup, fmt::format("expected {} degrees of freedom as in the scene, found {}",
                                                    structure.size(), ensemble.snapshots.rows()));
  }
  return pom_and_lnm(scene, structure, pod::pod(ensemble));
}

diagnostics::ModelVerdictOptions verdict_options(const scene::Scene& scene) {
  constexpr double kShareOfDuration = 0.2, kIntervalsOfExponents = 1000.0;
  constexpr double kLeastRecord = 2000.0, kLargestRecord = 20000.0;
  diagnostics::ModelVerdictOptions options{.sample = scene.time.sample};
  const double samples = std::clamp(scene.time.duration / scene.time.sample, kLeastRecord, kLargestRecord);
  options.samples = static_cast<Eigen::Index>(samples);
  options.tangent.transient = scene.validation.transient;
  options.tangent.duration = kShareOfDuration * scene.validation.lyapunov_duration;
  options.tangent.interval = options.tangent.duration / kIntervalsOfExponents;
  options.tangent.seed = scene.ensemble.seed;
  options.tangent.flow = scene.flow;
  return options;
}

diagnostics::ValidationOptions validation_options(const scene::Scene& scene,
                                                  const std::vector<diagnostics::Candidate>& candidates) {
  constexpr double kHorizonSamples = 1000.0, kIntervalsInHorizon = 5.0;
  const auto& spec = scene.validation;
  const diagnostics::Candidate& first = candidates.front();
  Eigen::VectorXd shares = first.captured;
  for (Eigen::Index i = shares.size() - 1; i > 0; --i) shares[i] -= shares[i - 1];
  Eigen::Index available = first.basis.modes();
  for (const auto& candidate : candidates) available = std::min(available, candidate.basis.modes());

  diagnostics::ValidationOptions options;
  options.speed = scene.drive.velocity(0.0);
  options.modes.assign(spec.modes.begin(), spec.modes.end());
  if (candidates.size() == 1) options.modes = {available};
  options.horizon = spec.horizon;
  options.horizon_gap = 2.0 * spec.horizon;
  options.sample = spec.horizon / kHorizonSamples;
  options.horizon_starts = spec.horizon_starts;
  options.orbit_speeds = spec.orbits;
  options.orbit_tolerance = spec.orbit_tolerance;
  options.chosen = candidates.size() == 1 ? available
                                          : chosen_modes(scene.reduction.choice, shares, available,
                                                         fmt::format("the ensemble's {} basis", first.name));
  options.grow = options.modes.empty();
  if (options.grow) options.modes = diagnostics::mode_ladder(available, options.chosen);
  options.sweep_values = spec.speeds.values();
  options.sweep_segments = static_cast<std::size_t>(spec.segments);
  options.settle = settle_options(scene);
  options.sweep_settle = sweep_settle_options(scene);
  options.lyapunov.duration = spec.lyapunov_duration;
  options.lyapunov.transient = spec.transient;
  options.lyapunov.interval = spec.horizon / kIntervalsInHorizon;
  options.lyapunov.seed = scene.ensemble.seed;
  options.lyapunov.flow = scene.flow;
  options.cost_duration = spec.cost_duration;
  options.cost_repeats = spec.cost_repeats;
  return options;
}

}  // namespace slipmode::cli
