#include <slipmode/studies/pipeline.hpp>

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/figures/file_figures.hpp>
#include <slipmode/figures/gnuplot.hpp>
#include <slipmode/results/ensemble_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/driven.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/ensemble.hpp>
#include <slipmode/studies/natural_modes.hpp>
#include <slipmode/studies/validation.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <functional>
#include <utility>

namespace slipmode::studies {
namespace {

namespace fs = std::filesystem;

/// True where a scene has what modes and reduced models are made of: an ensemble is asked for, or what needs one is.
bool gathers_ensemble(const scene::Scene& scene) {
  return has_section(scene, "ensemble") || has_section(scene, "reduction") || has_section(scene, "validation");
}

std::vector<LeftOut> left_out_of(const scene::Scene& scene) {
  std::vector<LeftOut> out;
  if (!gathers_ensemble(scene)) out.push_back({"ensemble, proper orthogonal modes and reduced models", "[ensemble]"});
  if (!has_section(scene, "validation"))
    out.push_back({"comparison of reduced models with the full one", "[validation]"});
  return out;
}

/// The pipeline's state on its way; each stage is timed under its name. Belt and shaker differ in what modes are made
/// of the ensemble, which reduced models are written, and how they are compared.
class Pipeline {
 public:
  Pipeline(const scene::Scene& scene, fs::path folder, const RunOptions& run)
      : run_(run),
        scene_(scene),
        folder_(std::move(folder)),
        shaken_(is_shaken(scene)),
        full_(scene::build_system(scene)) {}

  PipelineResult run() {
    const bool gathers = gathers_ensemble(scene_);
    result_.left_out = left_out_of(scene_);
    timed("modes", &Pipeline::modes);
    timed("trajectory", &Pipeline::trajectory);
    if (gathers) timed("ensemble", &Pipeline::ensemble);
    if (gathers) timed("pod", &Pipeline::pod);
    if (gathers) timed("reduce", &Pipeline::reduce);
    if (has_section(scene_, "validation")) timed("validate", &Pipeline::validate);
    timed("figures", &Pipeline::figures);
    return std::move(result_);
  }

 private:
  void timed(const std::string& name, void (Pipeline::*stage)()) {
    run_.check_interrupt();
    const auto start = std::chrono::steady_clock::now();
    (this->*stage)();
    result_.stages.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
  }

  fs::path file(const std::string& name) {
    result_.files.push_back(name);
    return folder_ / name;
  }

  void write(const std::string& name, results::FileKind kind, const std::function<void(results::StoreWriter&)>& fill,
             const std::optional<dynamics::EnergyAudit>& audit = {}) {
    results::StoreWriter writer(file(name), kind, scene_.units);
    results::Provenance provenance = results::provenance_of(scene_, "slipmode run");
    provenance.audit = audit;
    results::save(writer, provenance);
    fill(writer);
    writer.commit();
  }

  void modes() {
    constexpr Eigen::Index kShown = 20;
    result_.slipping = fem::natural_modes(full_.structure(), std::min(kShown, full_.size())).omega;
    if (!shaken_) result_.sticking = sticking_modes(full_, kShown).omega;  // a shaker's are not told
  }

  /// One run as [time] says; where an ensemble on a belt follows, only a stretch to look at.
  void trajectory() {
    constexpr double kExcerpt = 5.0, kFineSample = 1.0 / 400.0;  // slowest natural periods
    dynamics::SimulateOptions options = scene::simulate_options(scene_);
    const double period =
        scene_.drive.belt() != nullptr && gathers_ensemble(scene_) ? scene::slowest_period(scene_) : 0.0;
    if (period > 0.0) {
      options.duration = std::min(options.duration, options.transient + scene::to_one_digit(kExcerpt * period));
      options.sample = std::min(options.sample, scene::to_one_digit(kFineSample * period));
    }
    options.on_event = [this](const auto&, const auto&) { return run_.stop == nullptr || !run_.stop->load(); };
    const dynamics::Trajectory run = dynamics::simulate(full_, scene::initial_state(scene_, full_), options);
    run_.check_interrupt();
    write(
        "trajectory.h5", results::FileKind::kTrajectory,
        [&](results::StoreWriter& writer) {
          results::save(writer, results::kTrajectoryGroup, run);
          if (scene_.sensors) results::store_sensors(writer, scene_, run.q);
        },
        run.audit);
  }

  void ensemble() {
    const auto run = std::make_shared<diagnostics::EnsembleRun>(studies::ensemble(scene_, run_));
    content_of(scene_, run).save(file("ensemble.h5"));
    result_.snapshots = run->ensemble.snapshots.cols();
    result_.ensemble = std::move(*run);
  }

  void pod() {
    const pod::Ensemble snapshots = std::exchange(result_.ensemble->ensemble, {});
    if (shaken_) {
      result_.shaken_modes = shaken_modes(scene_, full_.structure(), snapshots);
      write("pod.h5", results::FileKind::kPod,
            [this](results::StoreWriter& writer) { results::save(writer, *result_.shaken_modes); });
    } else {
      result_.pod = pod::pod(snapshots);
      write("pod.h5", results::FileKind::kPod,
            [this](results::StoreWriter& writer) { results::save(writer, results::kPodGroup, *result_.pod); });
    }
  }

  void write_reduced(const std::string& name, const pod::Basis& basis) {
    write(name, results::FileKind::kReduced, [&](results::StoreWriter& writer) {
      results::save(writer, results::kReducedGroup,
                    results::ReducedModel{.system = rom::reduce(full_, basis), .basis = basis});
    });
  }

  /// Elsewhere POMs and LNMs of the same number, under a shaker the scene's own reduced model.
  void reduce() {
    if (shaken_) {
      const auto motion = [this]() -> const results::ShakenModes& { return *result_.shaken_modes; };
      bases_ = shaken_bases(scene_, full_, motion);
      const pod::Basis basis = shaken_basis(scene_.reduction.basis, scene_, full_, motion);
      result_.chosen = chosen_modes(scene_, scene_.reduction.choice, pod::cumulative(basis.energy), basis.modes(),
                                    fmt::format("basis '{}'", scene::to_string(scene_.reduction.basis)));
      write_reduced("reduced.h5", basis.truncated(result_.chosen));
      return;
    }
    bases_ = plain_bases(scene_, full_, *result_.pod);
    result_.chosen = validation_options(scene_, bases_).chosen;
    result_.reduced = bases_.front().name;
    result_.captured = bases_.front().captured[result_.chosen - 1];
    for (const pod::NamedBasis& basis : bases_) {
      const std::string name = basis.name == "POM" ? "pom" : basis.name == "LNM" ? "lnm" : "lnm_static";
      write_reduced(fmt::format("reduced_{}.h5", name), basis.basis.truncated(result_.chosen));
    }
  }

  void validate() {
    const Validation done = studies::validate(scene_, bases_, ValidationRequest{}, file("validation.h5"), run_);
    result_.driven_validation = done.driven;
    result_.validation = done.belt;
  }

  /// Files that show the same as another one are skipped.
  void figures() {
    const std::vector<std::string> skipped = {"reduced_pom.h5", "reduced_lnm.h5", "reduced_lnm_static.h5",
                                              "reduced.h5"};
    result_.figures = figures::save_figures_of(folder_, result_.files, skipped,
                                               {.threads = run_.threads, .stop = run_.stop, .progress = {}});
  }

  const RunOptions& run_;
  const scene::Scene& scene_;
  fs::path folder_;
  bool shaken_;
  dynamics::HybridSystem full_;
  std::vector<pod::NamedBasis> bases_;
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

PipelineResult pipeline(const scene::Scene& scene, const fs::path& folder, const RunOptions& run) {
  figures::require_gnuplot();  // not after hours of work
  return Pipeline(scene, folder, run).run();
}

}  // namespace slipmode::studies
