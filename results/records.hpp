#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/dynamics/system.hpp>
#include <slipmode/pod/basis.hpp>
#include <slipmode/pod/ensemble.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/results/store.hpp>

#include <string>

namespace slipmode::results {

// Typed content of result files. Each `save` fills one group; each `load` checks sizes and that numbers are finite, and
// throws InvalidInput naming file, dataset and remedy. The usual group names are the constants below.

inline constexpr const char* kTrajectoryGroup = "trajectory";
inline constexpr const char* kEnsembleGroup = "ensemble";
inline constexpr const char* kPodGroup = "pod";
inline constexpr const char* kBasisGroup = "basis";
inline constexpr const char* kSystemGroup = "system";
inline constexpr const char* kReducedGroup = "reduced";

/// A run: samples (time x quantity), events (one dataset per field), energy audit, statistics, final state.
void save(StoreWriter& store, const std::string& group, const dynamics::Trajectory& trajectory);
[[nodiscard]] dynamics::Trajectory load_trajectory(const StoreReader& store,
                                                   const std::string& group = kTrajectoryGroup);

/// Snapshots as time x dof, with the first row of each run.
void save(StoreWriter& store, const std::string& group, const pod::Ensemble& ensemble);
[[nodiscard]] pod::Ensemble load_ensemble(const StoreReader& store, const std::string& group = kEnsembleGroup);

/// Basis vectors as dof x mode, mean, energy shares, kind, provenance.
void save(StoreWriter& store, const std::string& group, const pod::Basis& basis);
/// Only "vectors" must be there: a basis made by hand or from measurements may leave out the rest.
/// @param dofs  the number of rows the basis must have (the structure's size), or kAny
[[nodiscard]] pod::Basis load_basis(const StoreReader& store, const std::string& group = kBasisGroup,
                                    Eigen::Index dofs = StoreReader::kAny);

/// The basis (in the sub-group "basis") with singular values, shares and rank.
void save(StoreWriter& store, const std::string& group, const pod::PodResult& result);
[[nodiscard]] pod::PodResult load_pod(const StoreReader& store, const std::string& group = kPodGroup,
                                      Eigen::Index dofs = StoreReader::kAny);

/// M, C, K (dense as matrices, sparse as row, column, value), contacts, drive, load.
void save(StoreWriter& store, const std::string& group, const dynamics::HybridSystem& system);
[[nodiscard]] dynamics::HybridSystem load_system(const StoreReader& store, const std::string& group = kSystemGroup);

/// A reduced model with the basis it was projected on, so that its states can be lifted.
struct ReducedModel {
  dynamics::HybridSystem system;
  pod::Basis basis;
};
void save(StoreWriter& store, const std::string& group, const ReducedModel& model);
[[nodiscard]] ReducedModel load_reduced(const StoreReader& store, const std::string& group = kReducedGroup);

/// Energy balance of a run, with its residual.
void save(StoreWriter& store, const std::string& group, const dynamics::EnergyAudit& audit);
[[nodiscard]] dynamics::EnergyAudit load_audit(const StoreReader& store, const std::string& group);

/// One state: time, q, v, contact modes.
void save(StoreWriter& store, const std::string& group, const dynamics::State& state);
[[nodiscard]] dynamics::State load_state(const StoreReader& store, const std::string& group);

}  // namespace slipmode::results
