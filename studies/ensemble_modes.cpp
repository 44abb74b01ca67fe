#include <slipmode/studies/ensemble_modes.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/exchange.hpp>
#include <slipmode/pod/pod_of_ranks.hpp>
#include <slipmode/studies/ensemble.hpp>
#include <slipmode/studies/result_file.hpp>

#include <fmt/format.h>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

namespace slipmode::studies {
namespace {

/// How members went.
struct Course {
  std::size_t members = 0;
  Eigen::Index snapshots = 0;
  std::vector<std::string> failures;
  std::optional<dynamics::EnergyAudit> audit;  ///< the worst

  explicit Course(const diagnostics::EnsembleRun& run)
      : members(run.members.size()), snapshots(run.ensemble.snapshots.cols()) {
    for (const auto& member : run.members)
      if (!member.failure.empty()) failures.push_back(member.failure);
    if (const auto* worst = run.worst()) audit = worst->audit;
  }

  void tell(const Exchange& exchange) const {
    static_assert(std::is_trivially_copyable_v<dynamics::EnergyAudit>);
    exchange.send(0, audit ? std::string_view(reinterpret_cast<const char*>(&*audit), sizeof *audit) : "");
    const std::vector<double> counts = {static_cast<double>(members), static_cast<double>(snapshots),
                                        static_cast<double>(failures.size())};
    exchange.send(0, counts);
    for (const std::string& failure : failures) exchange.send(0, failure);
  }

  /// What a later rank tells. Of equally bad members the first counts, as in one process.
  void add(Exchange& exchange, int rank) {
    if (const std::string bytes = exchange.bytes_from(rank); !bytes.empty()) {
      dynamics::EnergyAudit other;
      std::memcpy(&other, bytes.data(), sizeof other);
      if (!audit || std::abs(other.residual()) > std::abs(audit->residual())) audit = other;
    }
    const std::vector<double> counts = exchange.numbers_from(rank);
    members += static_cast<std::size_t>(counts[0]);
    snapshots += static_cast<Eigen::Index>(counts[1]);
    for (double k = 0; k < counts[2]; ++k) failures.push_back(exchange.bytes_from(rank));
  }
};

EnsembleModes modes_of(const scene::Scene& scene, const Course& course) {
  EnsembleModes modes{.found = {.scene = scene,
                                .provenance = results::provenance_of(scene, "slipmode pod"),
                                .dofs = scene.size(),
                                .snapshots = course.snapshots,
                                .pod = {},
                                .shaken = {}},
                      .members = course.members,
                      .failures = course.failures};
  modes.found.provenance.audit = course.audit;
  return modes;
}

EnsembleModes modes_of_ranks(const scene::Scene& scene, Eigen::Index modes, const RunOptions& run, const Ranks& ranks) {
  Exchange exchange(ranks, run.stop);
  const std::string study = fingerprint_of(scene, fmt::format("slipmode pod --modes {}", modes));
  for (int rank = 1; ranks.own == 0 && rank < ranks.count; ++rank) exchange.send(rank, study);
  if (ranks.own != 0) {
    require_same_study(exchange.bytes_from(0), study);
    exchange.send(0, "");
  }
  for (int rank = 1; ranks.own == 0 && rank < ranks.count; ++rank) (void)exchange.bytes_from(rank);

  const auto part = static_cast<std::size_t>(ranks.own) + 1, parts = static_cast<std::size_t>(ranks.count);
  const diagnostics::EnsembleRun own = ensemble_part(scene, part, parts, run);
  Course course(own);
  if (ranks.own != 0) course.tell(exchange);
  for (int rank = 1; ranks.own == 0 && rank < ranks.count; ++rank) course.add(exchange, rank);
  if (ranks.own == 0 && course.snapshots == 0) diagnostics::fail_all(course.failures.front());
  EnsembleModes all = modes_of(scene, course);
  try {
    all.found.pod = pod::pod_of_ranks(own.ensemble.snapshots, exchange, {.choice = {.modes = modes, .energy = 1.0}});
  } catch (const InvalidInputOfRank&) {
    throw;
  } catch (const InvalidInput& refusal) {
    throw refused_modes(scene.source.path, modes, refusal);
  }
  return all;
}

}  // namespace

EnsembleModes ensemble_modes(const scene::Scene& scene, Eigen::Index modes, const RunOptions& run, const Ranks* ranks) {
  if (!has_section(scene, "ensemble")) {
    throw InvalidInput(
        fmt::format("{}: has no [ensemble]; add one, or give the trajectory that 'slipmode simulate' makes of it",
                    scene.source.path));
  }
  require_modes(scene, modes, scene.source.path);
  if (ranks != nullptr) return modes_of_ranks(scene, modes, run, *ranks);
  const diagnostics::EnsembleRun run_of_all = ensemble(scene, run);
  EnsembleModes all = modes_of(scene, Course(run_of_all));
  MotionModes found = motion_modes(scene, run_of_all.ensemble, modes, scene.source.path);
  all.found.pod = std::move(found.pod);
  all.found.shaken = std::move(found.shaken);
  return all;
}

}  // namespace slipmode::studies
