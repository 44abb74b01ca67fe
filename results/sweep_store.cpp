#include <slipmode/results/sweep_store.hpp>

#include <slipmode/core/none.hpp>
#include <slipmode/core/numbers.hpp>
#include "results/internal/journal_line.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

namespace slipmode::results {
namespace {

using diagnostics::Motion;
using diagnostics::Settled;
using diagnostics::SlipState;
using diagnostics::SweepPoint;

void list_settled(detail::Line& line, SweepPoint& point) {
  Settled& own = point.settled;
  line(own.period.motion, own.period.period, own.period.T, own.period.contact, own.period.mismatch, own.stick_fraction,
       own.mean_energy, own.slip_rate, own.time, own.events, own.slips, own.end);
}

}  // namespace

diagnostics::SweepSink journal_sink(Journal& journal) {
  return detail::table_sink<Settled>(journal, "sweep", list_settled);
}

SweepAxis sweep_axis(const scene::Scene& scene, const std::string& key) {
  const std::string unit = scene::unit_of_key(scene, key);
  if (key == "drive.speed") return {key, "belt speed V", unit};
  if (key == "drive.frequency") return {key, "frequency f", unit};
  if (key == "drive.omega") return {key, "frequency ω", unit};
  if (key == "drive.amplitude")
    return {key, scene.force ? "amplitude of the force A" : "amplitude of the shaker", unit};
  if (key.starts_with("contact.") && key.ends_with(".stiffness")) return {key, "contact stiffness", unit};
  for (const std::string coordinate : {"displacement", "velocity"}) {
    const std::string start = "initial." + coordinate + ".";
    if (!key.starts_with(start)) continue;
    const auto dof = number_in<int>(key.substr(start.size()));
    if (!dof) continue;
    return {key, fmt::format("{} at the start, {}_{{{}}}", coordinate, coordinate.front() == 'd' ? "q" : "v", *dof + 1),
            unit};
  }
  const bool load = key.ends_with("normal_load") || key.ends_with("normal_load.constant");
  return {key, load ? "normal load" : key, unit};
}

void store_axis(StoreWriter& writer, const std::string& group, const SweepAxis& axis,
                const std::vector<double>& values) {
  writer.write(group + "/key", axis.key, {"", "the scene's key"});
  writer.write(group + "/label", axis.label, {"", "name of the key for an axis"});
  writer.write(group + "/values", values, {axis.units, axis.key});
}

void store_sweep(StoreWriter& writer, const std::string& group, const std::string& title, const SweepAxis& axis,
                 const Units& units, const std::vector<SweepPoint>& points) {
  std::vector<double> parameter, period, T, stick, energy, rate, time, events;
  std::vector<std::string> motion, failure;
  std::vector<double> slip_parameter, slip_contact, slip_displacement;
  for (const SweepPoint& point : points) {
    const Settled& settled = point.settled;
    const bool ok = point.ok();
    parameter.push_back(point.parameter);
    motion.push_back(ok ? diagnostics::to_string(settled.period.motion) : "failed");
    period.push_back(ok ? settled.period.period : kNone);
    T.push_back(ok ? settled.period.T : kNone);
    stick.push_back(ok ? settled.stick_fraction : kNone);
    energy.push_back(ok ? settled.mean_energy : kNone);
    rate.push_back(ok ? settled.slip_rate : kNone);
    time.push_back(ok ? settled.time : kNone);
    events.push_back(ok ? static_cast<double>(settled.events) : kNone);
    failure.push_back(point.failure);
    if (!ok) continue;
    for (const SlipState& slip : settled.slips) {
      slip_parameter.push_back(point.parameter);
      slip_contact.push_back(slip.contact);
      slip_displacement.push_back(slip.displacement);
    }
  }
  writer.describe_group(group, title);
  writer.write(group + "/title", title, {"", "which model"});
  writer.write(group + "/key", axis.key, {"", "the scene's key that was swept"});
  writer.write(group + "/label", axis.label, {"", "name of the key for an axis"});
  save(writer, group + "/values",
       Table{"one row per value of the key",
             {{"parameter", {axis.units, axis.key}, parameter},
              {"motion", {"", "periodic, aperiodic, undecided, sticking, sliding or failed"}, motion},
              {"period", {"", "slips per period; 0: not periodic"}, period},
              {"T", {units.time, "period; 0: not periodic"}, T},
              {"stick_fraction", {"1", "share of time in stick, mean over contacts whose law sticks"}, stick},
              {"mean_energy", {units.energy, "mean energy over the last block"}, energy},
              {"slip_rate", {units.rate, "slips of all contacts per unit of time"}, rate},
              {"time", {units.time, "simulated in all"}, time},
              {"events", {"", "events located"}, events},
              {"failure", {"", "why the value failed; empty: it did not"}, failure}}});
  save(writer, group + "/slips",
       Table{"one row per slip state: where a contact was when it began to slip",
             {{"parameter", {axis.units, axis.key}, slip_parameter},
              {"contact", {"", "number of the contact, from 0"}, slip_contact},
              {"displacement", {units.length, "displacement of the contact"}, slip_displacement}}});
}

std::string motion_text(const diagnostics::PeriodResult& period) {
  if (period.motion == Motion::kPeriodic) return fmt::format("period {}", period.period);
  return diagnostics::to_string(period.motion);
}

std::vector<MotionCount> count_motions(const std::vector<SweepPoint>& points) {
  constexpr int kFailed = 1000;
  std::map<std::pair<int, int>, MotionCount> counts;  // periodic ones by period first, then the other kinds
  for (const SweepPoint& point : points) {
    const auto& period = point.settled.period;
    const std::pair<int, int> key =
        point.ok() ? std::pair(static_cast<int>(period.motion), period.period) : std::pair(kFailed, 0);
    MotionCount& count = counts[key];
    count.motion = point.ok() ? motion_text(period) : "failed";
    ++count.values;
  }
  std::vector<MotionCount> out;
  out.reserve(counts.size());
  for (const auto& entry : counts) out.push_back(entry.second);
  return out;
}

std::string undecided_note(const std::vector<SweepPoint>& points, const Units& units) {
  double waited = 0.0;
  bool any = false;
  for (const SweepPoint& point : points) {
    if (!point.ok() || point.settled.period.motion != Motion::kUndecided) continue;
    waited = std::max(waited, point.settled.time);
    any = true;
  }
  if (!any) return {};
  return fmt::format(
      "  undecided: still settling, or too few slips to tell, after {:g} {}; to wait longer:\n"
      "  --set validation.sweep_limit={:g}\n",
      waited, units.times(), 10.0 * waited);
}

}  // namespace slipmode::results
