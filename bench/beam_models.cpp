#include "bench/beam_models.hpp"

#include <slipmode/pod/modal_fit.hpp>
#include <slipmode/pod/pomf.hpp>
#include <slipmode/pod/sensors.hpp>
#include <slipmode/rom/reduce.hpp>

namespace slipmode::bench {
namespace {

constexpr double kBasisFrequency = 12.0, kBasisTransient = 100.0, kBasisCycles = 100.0, kSamplesPerCycle = 64.0;

/// Modal functions as the scene's [sensors] and [reduction] say.
pod::Basis pomf_basis(const scene::Scene& scene, const fem::Beam& beam, const dynamics::HybridSystem& system) {
  const double period = 1.0 / kBasisFrequency;
  const auto run = dynamics::simulate(system.with_drive(scene::drive_at(scene, kBasisFrequency)), system.rest(),
                                      {.duration = (kBasisTransient + kBasisCycles) * period,
                                       .transient = kBasisTransient * period,
                                       .sample = period / kSamplesPerCycle,
                                       .keep_events = false,
                                       .flow = {.audit = false}});
  const Eigen::Index functions = scene.reduction.functions;
  const pod::SensorArray gauges = scene::sensor_array(scene, beam);
  const pod::SensorArray places(beam, pod::sensors_at(pod::SensorKind::kDisplacement, scene.sensors->x));
  const pod::ModalFit strains(gauges, pod::natural_functions(beam, functions));
  const pod::Ensemble moved = pod::converted({.snapshots = gauges.readings(run.q), .run_begin = {0}}, strains, places);
  const pod::ModeChoice choice = scene.reduction.choice;
  return pod::pomfs(beam, places, moved, {.functions = functions, .pod = {.choice = choice}}).basis;
}

}  // namespace

scene::Scene beam_scene() { return scene::load_scene(SLIPMODE_SOURCE_DIR "/datasets/beam_sweep/scene.toml"); }

std::vector<BeamModel> beam_models(const scene::Scene& scene) {
  const fem::Beam beam = scene::build_beam(scene);
  const Eigen::VectorXd gauge = beam.strain_row(scene::gauge_position(scene));
  const diagnostics::DrivenCase full{.system = scene::build_system(scene, beam),
                                     .readings = {.rows = gauge.transpose(), .offset = {}}};
  std::vector<BeamModel> models;
  models.push_back({.name = "POMF-3",
                    .shaken = diagnostics::reduced_case(full, pomf_basis(scene, beam, full.system)),
                    .wanted = {.odeint = 20.0, .tight = 60.0, .sweep_cpu_seconds = 10.0}});
  models.push_back({.name = "LNM-10",
                    .shaken = diagnostics::reduced_case(full, rom::lnm_basis(full.system.structure(), 10)),
                    .wanted = {.odeint = 40.0, .sweep_cpu_seconds = 30.0}});
  models.push_back({.name = "FE-80",
                    .shaken = full,
                    .stretches = 10,
                    .stretch = 0.1,
                    .wanted = {.odeint = 60.0, .sweep_cpu_seconds = 60.0}});
  return models;
}

}  // namespace slipmode::bench
