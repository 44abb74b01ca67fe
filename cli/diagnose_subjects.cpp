#include "cli/diagnose_subjects.hpp"

#include <slipmode/studies/bases.hpp>

#include <algorithm>
#include <utility>

namespace slipmode::cli {
namespace {

constexpr double kUsualPeriods = 500.0, kUsualIntervals = 1000.0;

/// Above so many directions the leading ones only are measured unless more are asked for.
constexpr Eigen::Index kAllUpTo = 64, kLeading = 8;

}  // namespace

DiagnoseSubjects diagnose_subjects(const scene::Scene& scene, const ModelRequest& request) {
  DiagnoseSubjects subjects{.full = scene::build_system(scene), .start = {}, .candidates = {}};
  subjects.start = scene::initial_state(scene, subjects.full);
  for (const std::string& file : request.files) {
    for (pod::NamedBasis& basis : studies::load_chosen_bases(scene, subjects.full, file, request.modes))
      subjects.candidates.push_back(std::move(basis));
  }
  return subjects;
}

diagnostics::TangentOptions tangent_options(const Session& session, const scene::Scene& scene,
                                            const dynamics::HybridSystem& full, const ModelRequest& request) {
  diagnostics::TangentOptions options;
  const std::optional<double> period = full.drive().period();
  const double usual = period ? kUsualPeriods * *period : std::max(scene.time.duration, scene.time.transient);
  options.transient = request.transient.value_or(scene.time.transient);
  options.duration = request.duration.value_or(usual);
  options.interval = request.interval.value_or(period ? *period : options.duration / kUsualIntervals);
  const bool many = 2 * full.size() + full.internal_size() > kAllUpTo;
  options.exponents = request.exponents == 0 && many ? kLeading : request.exponents;
  options.seed = scene.ensemble.seed;
  options.flow = scene.flow;
  options.flow.audit = false;
  options.stop = session.stop;
  return options;
}

}  // namespace slipmode::cli
