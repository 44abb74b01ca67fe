#include "cli/pipeline.hpp"

#include <slipmode/fem/modes.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/rom/reduce.hpp>
#include "cli/pipeline_figures.hpp"
#include "cli/validate_run.hpp"
#include "cli/validation_setup.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>

namespace slipmode::cli {
namespace {

namespace fs = std::filesystem;

/// The pipeline's state on its way; each stage is timed under its name.
class Pipeline {
 public:
  Pipeline(const Session& session, const scene::Scene& scene, fs::path folder)
      : session_(session), scene_(scene), folder_(std::move(folder)), full_(scene::build_system(scene)) {}

  PipelineResult run() {
    const bool validates = has_section(scene_, "validation"), gathers = gathers_ensemble(scene_);
    result_.left_out = left_out_of(scene_);
    timed("modes", [this] { modes(); });
    timed("trajectory", [this, gathers] { trajectory(gathers); });
    if (gathers) timed("ensemble", [this] { ensemble(); });
    if (gathers) timed("pod", [this] { pod(); });
    if (gathers) timed("reduce", [this] { reduce(); });
    if (validates) timed("validate", [this] { validate(); });
    timed("figures", [this] { figures(); });
    return std::move(result_);
  }

 private:
  template <class Work>
  void timed(const std::string& name, const Work& work) {
    session_.check_interrupt();
    const auto start = std::chrono::steady_clock::now();
    work();
    result_.stages.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
  }

  fs::path file(const std::string& name) {
    result_.files.push_back(name);
    return folder_ / name;
  }

  void modes() {
    constexpr Eigen::Index kShown = 20;
    const Eigen::Index n = full_.size(), contacts = static_cast<Eigen::Index>(full_.contacts().size());
    result_.slipping = fem::natural_modes(full_.structure(), std::min(kShown, n)).omega;
    if (n <= contacts || !can_stick(full_)) return;
    Eigen::MatrixXd w(n, contacts);
    for (Eigen::Index c = 0; c < contacts; ++c) w.col(c) = full_.contacts()[c].direction;
    result_.sticking = fem::constrained_modes(full_.structure(), w, std::min(kShown, n - contacts)).omega;
  }

  /// One run as [time] says; where an ensemble follows, only a stretch to look at.
  void trajectory(bool excerpt) {
    constexpr double kExcerpt = 200.0, kFineSample = 0.1;
    dynamics::SimulateOptions options = scene::simulate_options(scene_);
    if (excerpt) {
      options.duration = std::min(options.duration, options.transient + kExcerpt);
      options.sample = std::min(options.sample, kFineSample);
    }
    options.on_event = [this](const auto&, const auto&) { return !session_.stop->load(); };
    const auto run = dynamics::simulate(full_, scene::initial_state(scene_, full_), options);
    session_.check_interrupt();
    results::Provenance provenance = results::provenance_of(scene_, "slipmode run");
    provenance.audit = run.audit;
    results::StoreWriter writer(file("trajectory.h5"), scene_.units);
    results::save(writer, provenance);
    results::save(writer, results::kTrajectoryGroup, run);
    writer.commit();
  }

  void ensemble() {
    result_.ensemble = run_scene_ensemble(session_, scene_, full_);
    store_ensemble(file("ensemble.h5"), scene_, *result_.ensemble);
    result_.snapshots = result_.ensemble->ensemble.snapshots.cols();
  }

  void pod() {
    result_.pod = pod::pod(result_.ensemble->ensemble);
    result_.ensemble->ensemble = {};
    results::StoreWriter writer(file("pod.h5"), scene_.units);
    results::save(writer, results::provenance_of(scene_, "slipmode run"));
    results::save(writer, results::kPodGroup, *result_.pod);
    writer.commit();
  }

  void reduce() {
    candidates_ = pom_and_lnm(scene_, full_.structure(), *result_.pod);
    result_.chosen = validation_options(scene_, candidates_).chosen;
    for (const auto& candidate : candidates_) {
      const pod::Basis basis = candidate.basis.truncated(result_.chosen);
      const std::string name = fmt::format("reduced_{}.h5", candidate.name == "POM" ? "pom" : "lnm");
      results::StoreWriter writer(file(name), scene_.units);
      results::save(writer, results::provenance_of(scene_, "slipmode run"));
      results::save(writer, results::kReducedGroup,
                    results::ReducedModel{.system = rom::reduce(full_, basis), .basis = basis});
      writer.commit();
    }
  }

  void validate() {
    result_.validation = validate_into(session_, scene_, full_, candidates_, validation_options(scene_, candidates_),
                                       file("validation.h5"));
  }

  /// The reduced models' files have the same shapes as pod.h5.
  void figures() {
    result_.figures = save_figures_of(session_, folder_, result_.files, {"reduced_pom.h5", "reduced_lnm.h5"});
  }

  const Session& session_;
  const scene::Scene& scene_;
  fs::path folder_;
  dynamics::HybridSystem full_;
  std::vector<diagnostics::Candidate> candidates_;
  PipelineResult result_;
};

}  // namespace

double PipelineResult::basis_wall() const {
  double sum = 0.0;
  for (const Stage& stage : stages) {
    if (stage.name == "ensemble" || stage.name == "pod" || stage.name == "reduce") sum += stage.wall;
  }
  return sum;
}

PipelineResult run_pipeline(const Session& session, const scene::Scene& scene, const fs::path& folder) {
  return Pipeline(session, scene, folder).run();
}

}  // namespace slipmode::cli
