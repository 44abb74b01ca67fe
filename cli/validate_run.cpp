#include "cli/validate_run.hpp"

#include "cli/portraits.hpp"
#include "cli/sweep_store.hpp"
#include "cli/validation_store.hpp"
#include "scene/journal.hpp"
#include "scene/provenance.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

/// Names the models compared to the last bit, so that a journal of other models is never taken over.
std::string identity(const scene::Scene& scene, const std::vector<diagnostics::Candidate>& candidates) {
  const Eigen::MatrixXd& vectors = candidates.front().basis.vectors;
  const std::string bytes(reinterpret_cast<const char*>(vectors.data()),
                          static_cast<std::size_t>(vectors.size()) * sizeof(double));
  return scene::fingerprint(fmt::format("{} validate\n{}\n{}", scene::version(), scene::scene_to_toml(scene), bytes));
}

}  // namespace

diagnostics::ValidationReport validate_into(const Session& session, const scene::Scene& scene,
                                            const dynamics::HybridSystem& full,
                                            const std::vector<diagnostics::Candidate>& candidates,
                                            diagnostics::ValidationOptions options, const std::filesystem::path& file) {
  scene::Journal journal(scene::Journal::path_for(file), identity(scene, candidates));
  diagnostics::ValidationReport report;
  {
    ProgressLine line("validate", session.progress_mode());
    options.parallel = session.parallel(line);
    options.sink = journal_sink(journal);
    report = diagnostics::validate(full, candidates, scene::initial_state(scene, full), options);
  }
  if (report.interrupted) throw Interrupted();

  const Units units = Units::of(scene.units);
  scene::StoreWriter writer(file, scene.units);
  scene::save(writer, scene::provenance_of(scene, "slipmode validate"));
  store_validation(writer, report, scene);
  store_portraits(writer, "portraits/levels", level_portraits(full, candidates.front(), report), units);
  store_portraits(writer, "portraits/orbits", orbit_portraits(full, candidates.front(), report), units);
  writer.commit();
  journal.remove();
  return report;
}

}  // namespace slipmode::cli
