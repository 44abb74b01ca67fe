#include <slipmode/results/records.hpp>

#include "results/internal/checked_read.hpp"
#include "results/internal/event_record.hpp"
#include "results/internal/field_record.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>

namespace slipmode::results {

namespace {

constexpr std::array kBasisKinds = {pod::BasisKind::kPom,  pod::BasisKind::kLnm,       pod::BasisKind::kUser,
                                    pod::BasisKind::kPomf, pod::BasisKind::kLnmStatic, pod::BasisKind::kMassPom};
constexpr const char* kBasisWords = "pom, lnm, user, pomf, lnm+static or mass-pom";

pod::BasisKind load_kind(const StoreReader& store, const std::string& name) {
  constexpr const char* kFormerWord = "lnm_static";  // in files of version 0.1 before 2026-11-22
  const std::string written = store.text(name);
  const std::string kind = written == kFormerWord ? std::string(pod::to_string(pod::BasisKind::kLnmStatic)) : written;
  const auto found = std::ranges::find(kBasisKinds, kind, [](pod::BasisKind known) { return pod::to_string(known); });
  if (found == kBasisKinds.end()) store.fail(name, fmt::format("'{}'; expected {}", kind, kBasisWords));
  return *found;
}

/// Vectors of length 1; those of other kinds have a modal mass of 1.
bool has_unit_length(pod::BasisKind kind) { return kind == pod::BasisKind::kPom || kind == pod::BasisKind::kUser; }

}  // namespace

void save(StoreWriter& store, const std::string& group, const dynamics::EnergyAudit& audit) {
  store.describe_group(group, "energy balance: end - start = contact_work + force_work - viscous_loss");
  save_fields(store, group, audit);
  store.write(group + "/residual", audit.residual(), {"1", "what the balance leaves, over exchanged"});
}

dynamics::EnergyAudit load_audit(const StoreReader& store, const std::string& group) {
  return load_fields<dynamics::EnergyAudit>(store, group);
}

void save(StoreWriter& store, const std::string& group, const dynamics::State& state) {
  store.describe_group(group, "one state of the system");
  store.write(group + "/time", state.time, {"s", "time"});
  store.write(group + "/q", state.q, {"m", "displacement of each dof"});
  store.write(group + "/v", state.v, {"m/s", "velocity of each dof"});
  save_modes(store, group + "/modes", state.modes, "per contact; empty: to be derived");
  store.write(group + "/internal", state.internal,
              {"",
               "contacts' own states, contact after contact: spring stretch or bristle deflection [m], normal "
               "oscillator displacement [m] and velocity [m/s]; empty: none, or to be derived"});
}

dynamics::State load_state(const StoreReader& store, const std::string& group) {
  dynamics::State state;
  state.time = store.number(group + "/time");
  state.q = finite_vector(store, group + "/q");
  state.v = finite_vector(store, group + "/v", state.q.size());
  state.modes = load_modes(store, group + "/modes");
  const std::string internal = group + "/internal";
  if (store.has(internal)) state.internal = finite_vector(store, internal);  // files of earlier versions have none
  return state;
}

void save(StoreWriter& store, const std::string& group, const dynamics::Trajectory& trajectory) {
  store.describe_group(group, "a run: samples as time x quantity, events, energy audit, statistics, final state");
  store.write(group + "/time", trajectory.times, {"s", "sampling instants"});
  store.write_columns(group + "/q", trajectory.q, {"m", "displacements, time x dof"});
  store.write_columns(group + "/v", trajectory.v, {"m/s", "velocities, time x dof"});
  store.write_columns(group + "/contact_q", trajectory.contact_q, {"m", "contact displacements, time x contact"});
  store.write_columns(group + "/contact_v", trajectory.contact_v, {"m/s", "contact velocities, time x contact"});
  store.write_columns(group + "/lambda", trajectory.lambda, {"N", "contact forces, time x contact"});
  save_events(store, group + "/events", trajectory.events);
  store.write_columns(group + "/event_q", trajectory.event_q, {"m", "displacements at events, event x dof"});
  store.write_columns(group + "/event_v", trajectory.event_v, {"m/s", "velocities at events, event x dof"});
  save(store, group + "/final_state", trajectory.final_state);
  save(store, group + "/audit", trajectory.audit);
  store.describe_group(group + "/statistics", "what the run counted");
  save_fields(store, group + "/statistics", trajectory.statistics);
}

dynamics::Trajectory load_trajectory(const StoreReader& store, const std::string& group) {
  dynamics::Trajectory run;
  run.times = finite_vector(store, group + "/time");
  run.events = load_events(store, group + "/events");
  run.q = store.columns(group + "/q");
  run.v = store.columns(group + "/v", run.q.rows(), run.q.cols());
  run.contact_q = store.columns(group + "/contact_q");
  run.contact_v = store.columns(group + "/contact_v", run.contact_q.rows(), run.contact_q.cols());
  run.lambda = store.columns(group + "/lambda", run.contact_q.rows(), run.contact_q.cols());
  run.event_q = store.columns(group + "/event_q");
  run.event_v = store.columns(group + "/event_v", run.event_q.rows(), run.event_q.cols());
  for (const char* name : {"/q", "/contact_q"}) {
    const Eigen::Index instants = name == std::string("/q") ? run.q.cols() : run.contact_q.cols();
    if (instants != 0 && instants != run.times.size()) {
      store.fail(group + name, fmt::format("has {} instants, time has {}; the file is inconsistent, make it again",
                                           instants, run.times.size()));
    }
  }
  run.final_state = load_state(store, group + "/final_state");
  run.audit = load_audit(store, group + "/audit");
  run.statistics = load_fields<dynamics::FlowStatistics>(store, group + "/statistics");
  return run;
}

void save(StoreWriter& store, const std::string& group, const pod::Ensemble& ensemble) {
  store.describe_group(group, "snapshots of one or several runs");
  store.write_columns(group + "/snapshots", ensemble.snapshots, {"m", "displacements, time x dof, run after run"});
  store.write(group + "/run_begin", std::vector<std::int64_t>(ensemble.run_begin.begin(), ensemble.run_begin.end()),
              {"", "first row of each run, from 0"});
}

pod::Ensemble load_ensemble(const StoreReader& store, const std::string& group) {
  pod::Ensemble ensemble;
  ensemble.snapshots = finite_columns(store, group + "/snapshots", StoreReader::kAny, StoreReader::kAny);
  const std::string name = group + "/run_begin";
  const auto begin = codes(store, name, StoreReader::kAny, 0, std::max<Eigen::Index>(0, ensemble.snapshots.cols()));
  if (!std::ranges::is_sorted(begin) || (!begin.empty() && begin.front() != 0)) {
    store.fail(name, "is not an ascending list from 0; the file is damaged, make it again");
  }
  ensemble.run_begin.assign(begin.begin(), begin.end());
  return ensemble;
}

void save(StoreWriter& store, const std::string& group, const pod::Basis& basis) {
  store.describe_group(group, "affine basis q = mean + vectors a");
  store.write(group + "/vectors", basis.vectors,
              {has_unit_length(basis.kind) ? "1" : "kg^-1/2", "basis vectors, dof x mode"});
  store.write(group + "/mean", basis.mean, {"m", "mean displacement of each dof"});
  store.write(group + "/energy", basis.energy, {"1", "share of the ensemble's energy in each mode; empty: unknown"});
  store.write(group + "/kind", std::string(pod::to_string(basis.kind)), {"", kBasisWords});
  store.write(group + "/provenance", basis.provenance, {"", "how the basis was made"});
}

pod::Basis load_basis(const StoreReader& store, const std::string& group, Eigen::Index dofs) {
  pod::Basis basis;
  const std::string vectors = group + "/vectors";
  basis.vectors = finite_matrix(store, vectors, dofs);
  if (basis.vectors.cols() < 1 || basis.vectors.cols() > basis.vectors.rows()) {
    store.fail(vectors, fmt::format("has {} modes of {} dofs; expected 1 to {} modes", basis.vectors.cols(),
                                    basis.vectors.rows(), basis.vectors.rows()));
  }
  const auto optional = [&](const char* name) { return store.has(group + "/" + name); };
  basis.mean = Eigen::VectorXd::Zero(basis.vectors.rows());
  const bool centred = optional("mean") && store.vector(group + "/mean").size() > 0;  // a basis may have no mean
  if (centred) basis.mean = finite_vector(store, group + "/mean", basis.vectors.rows());
  if (optional("energy")) basis.energy = finite_vector(store, group + "/energy");
  if (basis.energy.size() != 0 && basis.energy.size() != basis.modes()) {
    store.fail(group + "/energy", fmt::format("has {} values for {} modes; expected one each, or none",
                                              basis.energy.size(), basis.modes()));
  }
  if (optional("kind")) basis.kind = load_kind(store, group + "/kind");
  if (optional("provenance")) basis.provenance = store.text(group + "/provenance");
  return basis;
}

void save(StoreWriter& store, const std::string& group, const pod::PodResult& result) {
  store.describe_group(group, "proper orthogonal decomposition of an ensemble");
  save(store, group + "/basis", result.basis);
  store.write(group + "/singular_values", result.singular_values,
              {has_unit_length(result.basis.kind) ? "m" : "kg^1/2 m", "of the mean-removed snapshots over sqrt(T)"});
  store.write(group + "/shares", result.shares, {"1", "share of the ensemble's energy in each mode"});
  store.write(group + "/rank", std::int64_t{result.rank}, {"", "singular values above rounding"});
}

pod::PodResult load_pod(const StoreReader& store, const std::string& group, Eigen::Index dofs) {
  pod::PodResult result;
  result.basis = load_basis(store, group + "/basis", dofs);
  result.singular_values = finite_vector(store, group + "/singular_values");
  result.shares = finite_vector(store, group + "/shares", result.singular_values.size());
  result.rank = store.integer(group + "/rank");
  return result;
}

}  // namespace slipmode::results
