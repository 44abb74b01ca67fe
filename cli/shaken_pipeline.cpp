#include "cli/shaken_pipeline.hpp"
#include "cli/validation_report.hpp"

#include <slipmode/fem/modes.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/rom/reduce.hpp>
#include "cli/file_figures.hpp"
#include "cli/pipeline.hpp"
#include "cli/pipeline_figures.hpp"
#include "cli/shaken_bases.hpp"
#include "cli/shaken_model.hpp"
#include "cli/shaken_validation.hpp"
#include "cli/steps.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <numbers>

namespace slipmode::cli {
namespace {

namespace fs = std::filesystem;

/// The pipeline's state on its way; each stage is timed under its name.
class ShakenPipeline {
 public:
  ShakenPipeline(const Session& session, const scene::Scene& scene, fs::path folder)
      : session_(session), scene_(scene), folder_(std::move(folder)), full_(scene::build_system(scene)) {
    report_.data = {{"verb", "run"}, {"title", scene.title}, {"units", scene.units}};
    report_.text = scene.title + "\n";
  }

  Report run() {
    const bool validates = has_section(scene_, "validation"), gathers = gathers_ensemble(scene_);
    timed("modes", [this] { modes(); });
    timed("trajectory", [this] { trajectory(); });
    if (gathers) timed("ensemble", [this] { ensemble(); });
    if (gathers) timed("pod", [this] { pod(); });
    if (gathers) timed("reduce", [this] { reduce(); });
    if (validates) timed("validate", [this] { validate(); });
    timed("figures", [this] { figures(); });
    const std::vector<LeftOut> left_out = left_out_of(scene_);
    if (!left_out.empty()) report_.data["left_out"] = to_json(left_out);
    report_.text += left_out_text(left_out) + "\n  " + times_ + '\n';
    report_.data["files"] = files_;
    return std::move(report_);
  }

 private:
  template <class Work>
  void timed(const std::string& name, const Work& work) {
    session_.check_interrupt();
    const auto start = std::chrono::steady_clock::now();
    work();
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    report_.data["seconds"][name] = wall;
    times_ += fmt::format("{}{} {:.2f} s", times_.empty() ? "" : ", ", name, wall);
  }

  fs::path file(const std::string& name) {
    files_.push_back(name);
    return folder_ / name;
  }

  void modes() {
    constexpr Eigen::Index kShown = 6;
    const Eigen::VectorXd hz =
        fem::natural_modes(full_.structure(), std::min(kShown, full_.size())).omega / (2.0 * std::numbers::pi);
    report_.data["modes"] = {{"slipping_hz", std::vector<double>(hz.begin(), hz.end())}};
    report_.text += "  frequencies f [Hz], slipping:";
    for (const double f : hz) report_.text += fmt::format(" {:.5g}", f);
    report_.text += '\n';
  }

  void trajectory() {
    dynamics::SimulateOptions options = scene::simulate_options(scene_);
    options.on_event = [this](const auto&, const auto&) { return !session_.stop->load(); };
    const auto run = dynamics::simulate(full_, scene::initial_state(scene_, full_), options);
    session_.check_interrupt();
    results::Provenance provenance = results::provenance_of(scene_, "slipmode run");
    provenance.audit = run.audit;
    results::StoreWriter writer(file("trajectory.h5"), scene_.units);
    results::save(writer, provenance);
    results::save(writer, results::kTrajectoryGroup, run);
    if (scene_.sensors) store_sensors(writer, scene_, run.q);
    writer.commit();
  }

  void ensemble() {
    const diagnostics::EnsembleRun run = run_scene_ensemble(session_, scene_, full_);
    store_ensemble(file("ensemble.h5"), scene_, run);
    snapshots_ = run.ensemble;
    Json failures = Json::array();
    for (const auto& member : run.members) {
      if (!member.failure.empty()) failures.push_back(member.failure);
    }
    report_.data["ensemble"] = {{"runs", run.members.size()},
                                {"snapshots", snapshots_.snapshots.cols()},
                                {"audit_residual", worst_audit(run)},
                                {"failures", failures}};
    report_.text += fmt::format("  ensemble: {} runs, {} snapshots, largest energy residual {:.1e}\n",
                                run.members.size(), snapshots_.snapshots.cols(), worst_audit(run));
  }

  void pod() {
    modes_ = shaken_modes(scene_, full_.structure(), snapshots_);
    snapshots_ = {};
    results::StoreWriter writer(file("pod.h5"), scene_.units);
    results::save(writer, results::provenance_of(scene_, "slipmode run"));
    save(writer, modes_);
    writer.commit();
    report_.data["pod"] = json_of(modes_);
    report_.text += '\n' + text_of(modes_);
  }

  /// The scene's own reduced model.
  void reduce() {
    const auto made = [this]() -> const ShakenModes& { return modes_; };
    candidates_ = shaken_candidates(scene_, full_, made);
    const pod::Basis basis = shaken_basis(scene_.reduction.basis, scene_, full_, made);
    const Eigen::Index modes = chosen_modes(scene_.reduction.choice, basis.energy, basis.modes(),
                                            fmt::format("basis '{}'", scene::to_string(scene_.reduction.basis)));
    const pod::Basis kept = basis.truncated(modes);
    results::StoreWriter writer(file("reduced.h5"), scene_.units);
    results::save(writer, results::provenance_of(scene_, "slipmode run"));
    results::save(writer, results::kReducedGroup,
                  results::ReducedModel{.system = rom::reduce(full_, kept), .basis = kept});
    writer.commit();
    report_.data["reduction"] = {{"basis", scene::to_string(scene_.reduction.basis)}, {"modes", modes}};
  }

  void validate() {
    const auto found = validate_shaken_into(session_, scene_, candidates_, file("validation.h5"));
    report_.data["validation"] = to_json(found);
    report_.text += '\n' + summary_text(found, scene_);
  }

  void figures() {
    report_.data["figures"] = save_figures_of(session_, folder_, files_, {"reduced.h5", "ensemble.h5"});
  }

  const Session& session_;
  const scene::Scene& scene_;
  fs::path folder_;
  dynamics::HybridSystem full_;
  pod::Ensemble snapshots_;
  ShakenModes modes_;
  std::vector<diagnostics::DrivenCandidate> candidates_;
  std::vector<std::string> files_;
  std::string times_;
  Report report_;
};

}  // namespace

Report run_shaken_pipeline(const Session& session, const scene::Scene& scene, const fs::path& folder) {
  return ShakenPipeline(session, scene, folder).run();
}

}  // namespace slipmode::cli
