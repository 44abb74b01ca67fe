#include "cli/diagnose_subjects.hpp"

#include <slipmode/results/records.hpp>
#include "cli/shaken_bases.hpp"
#include "cli/shaken_model.hpp"
#include "cli/steps.hpp"
#include "cli/validation_setup.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {
namespace {

constexpr double kUsualPeriods = 500.0, kUsualIntervals = 1000.0;

/// Above so many directions the leading ones only are measured unless more are asked for.
constexpr Eigen::Index kAllUpTo = 64, kLeading = 8;

/// A basis with the share of energy in its first L vectors; empty where that is not known.
struct BasisOption {
  std::string name;
  pod::Basis basis;
  Eigen::VectorXd captured;
};

std::vector<BasisOption> basis_options(const scene::Scene& scene, const dynamics::HybridSystem& full,
                                       const std::string& file) {
  std::vector<BasisOption> out;
  if (is_shaken(scene)) {
    for (diagnostics::DrivenCandidate& candidate : load_shaken_candidates(scene, full, file))
      out.push_back({.name = candidate.name, .basis = std::move(candidate.basis), .captured = {}});
    return out;
  }
  for (diagnostics::Candidate& candidate : load_candidates(scene, full.structure(), file))
    out.push_back({candidate.name, std::move(candidate.basis), std::move(candidate.captured)});
  return out;
}

/// As asked on the command line, else all of a reduced model's, else as [reduction] chooses by the energies there are.
Eigen::Index modes_taken(const scene::Scene& scene, const BasisOption& choice, const std::string& file, bool is_reduced,
                         Eigen::Index asked) {
  const Eigen::Index available = choice.basis.modes();
  if (asked > available)
    throw InvalidInput(fmt::format("--modes {}: '{}' has {} {}s", asked, file, available, choice.name));
  if (asked > 0) return asked;
  if (is_reduced) return available;
  if (choice.captured.size() == 0 && scene.reduction.choice.modes == 0)
    throw InvalidInput(fmt::format("'{}' leaves the number of {}s open; say how many with --modes", file, choice.name));
  Eigen::VectorXd shares = choice.captured;
  for (Eigen::Index i = shares.size() - 1; i > 0; --i) shares[i] -= shares[i - 1];
  return chosen_modes(scene.reduction.choice, shares, available, fmt::format("the {}s of '{}'", choice.name, file));
}

}  // namespace

DiagnoseSubjects diagnose_subjects(const scene::Scene& scene, const ModelRequest& request) {
  DiagnoseSubjects subjects{.full = scene::build_system(scene), .start = {}, .candidates = {}};
  subjects.start = scene::initial_state(scene, subjects.full);
  for (const std::string& file : request.files) {
    const bool is_reduced = results::StoreReader(file).has(results::kReducedGroup);
    for (const BasisOption& choice : basis_options(scene, subjects.full, file)) {
      const Eigen::Index modes = modes_taken(scene, choice, file, is_reduced, request.modes);
      subjects.candidates.push_back(
          {.name = fmt::format("{} {}s", modes, choice.name), .basis = choice.basis.truncated(modes)});
    }
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
