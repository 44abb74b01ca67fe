// From a scene to figures: four masses on a belt, their proper orthogonal modes, reduced models beside the full one.
// scene_pipeline [FOLDER]: results and figures; by default scene_pipeline_results
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/pipeline.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>

constexpr const char* kScene = R"(
title = "Four masses on a belt"
units = "dimensionless"
structure = { kind = "chain", masses = 4, mass = 1.0, stiffness = 1.0, damping = 0.01, ends = "fixed-free" }
contact = [{ at = 4, law = "stribeck", mu_s = 0.4, mu_k = 0.2, alpha = 8.0, normal_load = 3.0 }]
drive = { kind = "belt", speed = 0.3 }
time = { duration = 2000.0, transient = 1000.0, sample = 0.5 }
ensemble = { members = 4, seed = 1, spread = 0.1 }
reduction = { basis = "pom", modes = 2 }
validation = { orbits = [], lyapunov_duration = 500.0, speeds = { from = 0.4, to = 0.3, step = 0.05 } }
)";

int main(int count, char** arguments) {
  using namespace slipmode;
  const scene::Scene scene = scene::with_own_times(scene::parse_scene(kScene));
  const std::filesystem::path folder = count > 1 ? arguments[1] : "scene_pipeline_results";
  std::filesystem::create_directories(folder);
  const studies::PipelineResult result = studies::pipeline(scene, folder);

  for (const studies::PipelineResult::Stage& stage : result.stages) {
    std::printf("%s: %.2f s\n", stage.name.c_str(), stage.wall);
  }
  const diagnostics::CandidateReport& poms = result.validation->candidates.front();
  for (const diagnostics::ShareRow& row : poms.shares) {
    std::printf("%d modes hold %.2f %%: deviation %.3g %%\n", static_cast<int>(row.modes), row.energy, row.horizon.dX);
  }
  std::printf("%zu figures in %s\n", result.figures.size(), folder.c_str());

  // Lowest frequency of n equal masses, fixed-free: 2 sin(pi / (4 n + 2)). All four modes are the full model in other
  // coordinates: no deviation but rounding, which the motion magnifies.
  const double lowest = 2.0 * std::sin(3.14159265358979 / 18.0), deviation = poms.shares.back().horizon.dX;
  return std::abs(result.slipping[0] - lowest) < 1e-12 && deviation < 1e-6 && !result.figures.empty() ? 0 : 1;
}
