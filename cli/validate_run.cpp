#include "cli/validate_run.hpp"

#include <slipmode/results/journal.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/results/validation_store.hpp>
#include "cli/portraits.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

/// Names the models compared to the last bit, so that a journal of other models is never taken over.
std::string identity(const scene::Scene& scene, const std::vector<diagnostics::Candidate>& candidates) {
  const Eigen::MatrixXd& vectors = candidates.front().basis.vectors;
  const std::string bytes(reinterpret_cast<const char*>(vectors.data()),
                          static_cast<std::size_t>(vectors.size()) * sizeof(double));
  return results::fingerprint(
      fmt::format("{} validate\n{}\n{}", results::version(), scene::scene_to_toml(scene), bytes));
}

}  // namespace

diagnostics::ValidationReport validate_into(const Session& session, const scene::Scene& scene,
                                            const dynamics::HybridSystem& full,
                                            const std::vector<diagnostics::Candidate>& candidates,
                                            diagnostics::ValidationOptions options, const std::filesystem::path& file) {
  results::Journal journal(results::Journal::path_for(file), identity(scene, candidates));
  diagnostics::ValidationReport report;
  {
    ProgressLine line("validate", session.progress_mode());
    options.parallel = session.parallel(line);
    options.sink = results::journal_sink(journal);
    report = diagnostics::validate(full, candidates, scene::initial_state(scene, full), options);
  }
  if (report.interrupted) throw Interrupted();

  const results::Units units = results::Units::of(scene.units);
  results::StoreWriter writer(file, scene.units);
  results::save(writer, results::provenance_of(scene, "slipmode validate"));
  results::store_validation(writer, report, scene);
  store_portraits(writer, "portraits/levels", level_portraits(full, candidates.front(), report), units);
  store_portraits(writer, "portraits/orbits", orbit_portraits(full, candidates.front(), report), units);
  writer.commit();
  journal.remove();
  return report;
}

}  // namespace slipmode::cli
