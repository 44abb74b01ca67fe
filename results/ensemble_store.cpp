#include <slipmode/results/ensemble_store.hpp>

#include <slipmode/results/records.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/results/units.hpp>
#include "results/internal/journal_line.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace slipmode::results {
namespace {

void list_member(detail::Line& line, SweptValue<diagnostics::MemberRun>& member) {
  auto& [snapshots, audit, statistics] = member.settled;
  line(audit.energy_start, audit.energy_end, audit.contact_work, audit.drive_work, audit.friction_loss,
       audit.force_work, audit.viscous_loss, audit.exchanged);
  line(statistics.steps, statistics.rejected, statistics.certified, statistics.events, statistics.regimes_built,
       statistics.stick_time);
  line(snapshots);
}

}  // namespace

diagnostics::EnsembleSink ensemble_sink(Journal& journal) {
  using std::chrono::steady_clock;
  auto sink = detail::table_sink<diagnostics::MemberRun>(journal, "ensemble", list_member);
  if (journal.is_of_several()) return sink;
  sink.store = [store = sink.store, last = steady_clock::now()](const auto& member) mutable {
    if (steady_clock::now() - last < std::chrono::seconds(1)) return;
    store(member);
    last = steady_clock::now();
  };
  return sink;
}

void store_ensemble(StoreWriter& writer, const scene::Scene& scene, const diagnostics::EnsembleRun& run) {
  const Units units = Units::of(scene.units);
  Table members{.description = "runs of the ensemble", .columns = {}};
  std::vector<double> parameter, start, columns, events, residual;
  std::vector<std::string> failure;
  for (const auto& member : run.members) {
    parameter.push_back(member.parameter);
    start.push_back(static_cast<double>(member.start));
    columns.push_back(static_cast<double>(member.columns));
    events.push_back(static_cast<double>(member.statistics.events));
    residual.push_back(member.failure.empty() ? member.audit.residual() : std::numeric_limits<double>::quiet_NaN());
    failure.push_back(member.failure);
  }
  const std::string key = drive_key(scene);
  const Column driven = key == "drive.frequency"
                            ? Column{"frequency", {units.frequency, "frequency of the drive"}, parameter}
                        : key == "drive.omega" ? Column{"omega", {units.angular, "frequency of the force"}, parameter}
                                               : Column{"speed", {units.velocity, "belt speed"}, parameter};
  members.columns = {driven,
                     {"start", {"", "number of the initial state"}, start},
                     {"snapshots", {"", "snapshots it gave"}, columns},
                     {"events", {"", "events located"}, events},
                     {"audit_residual", {"1", "energy balance relative to the energy exchanged"}, residual},
                     {"failure", {"", "why it failed; empty: it did not"}, failure}};
  save(writer, kEnsembleGroup, run.ensemble);
  save(writer, "members", members);
  if (scene.sensors) store_sensors(writer, scene, run.ensemble.snapshots);
}

void store_sensors(StoreWriter& writer, const scene::Scene& scene, const Eigen::MatrixXd& q) {
  const bool strain = scene.sensors->kind == pod::SensorKind::kStrain;
  writer.describe_group("sensors", "what the scene's sensors read, noise included");
  writer.write("sensors/x", scene.sensors->x, {"m", "places, from the clamp"});
  writer.write("sensors/kind", std::string(strain ? "strain" : "displacement"), {"", "what they read"});
  writer.write_columns("sensors/readings", sensor_readings(scene, scene::build_beam(scene), q),
                       {strain ? "1" : "m", "time x sensor"});
}

pod::Ensemble load_snapshots(const StoreReader& store) {
  const FileKind kind = require_kind(store, std::array{FileKind::kEnsemble, FileKind::kTrajectory, FileKind::kOrbit});
  if (kind == FileKind::kEnsemble) return load_ensemble(store);
  return {.snapshots = load_trajectory(store).q, .run_begin = {0}};
}

}  // namespace slipmode::results
