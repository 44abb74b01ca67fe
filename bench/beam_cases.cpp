#include "bench/beam_cases.hpp"

#include "bench/beam_models.hpp"
#include "bench/clock.hpp"
#include "bench/machine.hpp"
#include "bench/shaken_peers.hpp"

#include <fmt/format.h>
#include <array>
#include <cmath>

namespace slipmode::bench {
namespace {

using dynamics::HybridSystem;
using dynamics::State;

constexpr double kCycles = 600.0, kTransientCycles = 100.0;
constexpr double kTolerance = 1e-9, kTightTolerance = 1e-12, kReferenceTolerance = 1e-14;
constexpr int kRepeats = 5;
constexpr double kWantedCvode = 300.0, kWantedOdeintStuck = 25.0;
constexpr std::array kPeers = {ShakenMethod::kAdams, ShakenMethod::kBdf, ShakenMethod::kDopri5};

/// What one method needs and how wrong it is.
struct Figures {
  double seconds = 0.0;  ///< CPU, per cycle
  double events = 0.0;   ///< per cycle, on the stretches
  std::vector<double> errors = {};

  void add(const std::vector<double>& reached, const std::vector<double>& truth, std::size_t found, double cycles) {
    errors.push_back(energy_distance(reached, truth) / energy_norm(truth));
    events += static_cast<double>(found) / cycles;
  }
};

struct BeamRow {
  std::string model;
  double frequency = 0.0;
  WantedBeam wanted;
  double events = 0.0;                             ///< per cycle, over 600
  double long_seconds = 0.0, plain_seconds = 0.0;  ///< of slipmode, per cycle, over 600: audit on and off
  Figures slipmode;                                ///< audit on
  std::array<Figures, kPeers.size()> peers;
  Figures tight;                  ///< dopri5 at 1e-12
  double reference_events = 0.0;  ///< per cycle, on the stretches

  [[nodiscard]] double ratio_cvode() const { return std::min(peers[0].seconds, peers[1].seconds) / slipmode.seconds; }
  [[nodiscard]] double ratio_odeint() const { return peers[2].seconds / slipmode.seconds; }
  [[nodiscard]] double ratio_tight() const { return tight.seconds / slipmode.seconds; }
  [[nodiscard]] double wanted_odeint() const { return events > 0.0 ? wanted.odeint : kWantedOdeintStuck; }
  [[nodiscard]] double wanted_tight() const { return events > 0.0 ? wanted.tight : 0.0; }
};

dynamics::Trajectory advance(const HybridSystem& system, const State& from, double duration, bool audit = true) {
  return dynamics::simulate(system, from, {.duration = duration, .flow = {.audit = audit}});
}

bool changes_contact(const dynamics::Event& event) {
  return event.before != event.after || event.kind == dynamics::EventKind::kJump;
}

std::size_t changes(const dynamics::Trajectory& run) {
  return static_cast<std::size_t>(std::count_if(run.events.begin(), run.events.end(), changes_contact));
}

/// Starts on the attractor, a few cycles and an equal share of a cycle apart.
std::vector<State> starts_of(const HybridSystem& system, const BeamModel& model, double period) {
  constexpr double kApart = 5.0;
  State state =
      advance(system, dynamics::handed_on(system, system.rest(), system.drive().shaker()->next_upward_zero(0.0)),
              kTransientCycles * period)
          .final_state;
  std::vector<State> starts;
  for (int k = 0; k < model.stretches; ++k) {
    starts.push_back(state);
    state = advance(system, state, (kApart + 1.0 / model.stretches) * period).final_state;
  }
  return starts;
}

void time_slipmode(BeamRow& row, const HybridSystem& system, const State& start, double period) {
  std::vector<double> audited, plain;
  for (int i = 0; i < kRepeats; ++i) {
    audited.push_back(thread_seconds_of([&] {
      const auto run = advance(system, start, kCycles * period);
      row.events = static_cast<double>(changes(run)) / kCycles;
    }));
    plain.push_back(thread_seconds_of([&] { (void)advance(system, start, kCycles * period, false); }));
  }
  row.long_seconds = median(audited) / kCycles;
  row.plain_seconds = median(plain) / kCycles;
}

BeamRow measure(const BeamModel& model, const scene::Scene& scene, double frequency) {
  const HybridSystem system = model.shaken.system.with_drive(scene::drive_at(scene, frequency));
  const ShakenCoordinates coordinates(system);
  const double period = 1.0 / frequency, duration = model.stretch * period;
  const double cycles = model.stretch * model.stretches;
  BeamRow row{
      .model = model.name, .frequency = frequency, .wanted = model.wanted, .slipmode = {}, .peers = {}, .tight = {}};
  const std::vector<State> starts = starts_of(system, model, period);
  time_slipmode(row, system, starts.front(), period);
  for (const State& start : starts) {
    const ShakenPoint from = coordinates.point(start);
    const ShakenRun truth = run_shaken_reference(coordinates.problem(), from, duration, kReferenceTolerance);
    row.reference_events += static_cast<double>(truth.event_times.size()) / cycles;
    dynamics::Trajectory own;
    std::vector<double> seconds;
    for (int i = 0; i < kRepeats; ++i) {
      seconds.push_back(thread_seconds_of([&] { own = advance(system, start, duration); }));
    }
    row.slipmode.seconds += median(seconds) / cycles;
    row.slipmode.add(coordinates.point(own.final_state).y, truth.y, changes(own), cycles);
    const auto run_peer = [&](ShakenMethod method, double tolerance, Figures& out) {
      ShakenRun run;
      const auto work = [&] { run = run_shaken(method, coordinates.problem(), from, duration, tolerance); };
      out.seconds += thread_seconds_of(work) / cycles;
      out.add(run.y, truth.y, run.event_times.size(), cycles);
    };
    for (std::size_t m = 0; m < kPeers.size(); ++m) run_peer(kPeers[m], kTolerance, row.peers[m]);
    run_peer(ShakenMethod::kDopri5, kTightTolerance, row.tight);
  }
  return row;
}

std::string line(const BeamRow& row) {
  const auto microseconds = [](double seconds) { return fmt::format("{:10.3g}", 1e6 * seconds); };
  const auto wanted = [](double ratio) { return ratio > 0.0 ? fmt::format("{:.0f}", wanted_share() * ratio) : "-"; };
  std::string out =
      fmt::format("{:<7}{:6.1f}{:9.2f}{}{}{:6.2f} |{:9.2f}{}", row.model, row.frequency, row.events,
                  microseconds(row.long_seconds), microseconds(row.plain_seconds), row.long_seconds / row.plain_seconds,
                  row.reference_events, microseconds(row.slipmode.seconds));
  for (const Figures& peer : row.peers) out += microseconds(peer.seconds);
  return out + fmt::format("{}{:9.0f}{:>7}{:8.1f}{:>7}{:8.1f}{:>7}", microseconds(row.tight.seconds), row.ratio_cvode(),
                           wanted(kWantedCvode), row.ratio_odeint(), wanted(row.wanted_odeint()), row.ratio_tight(),
                           wanted(row.wanted_tight()));
}

std::string error_line(const BeamRow& row) {
  const auto pair = [](const Figures& f) {
    return fmt::format("{:10.1e}{:8.1e}{:8.2f}", median(f.errors), *std::max_element(f.errors.begin(), f.errors.end()),
                       f.events);
  };
  std::string out =
      fmt::format("{:<7}{:6.1f}{:8.2f}{}", row.model, row.frequency, row.reference_events, pair(row.slipmode));
  for (const Figures& peer : row.peers) out += pair(peer);
  return out + pair(row.tight);
}

void add_figures(const BeamRow& row, Row& out_row) {
  const auto add = [&](const char* what, double value) {
    out_row.figures.emplace_back(fmt::format("{} {:g} Hz: {}", row.model, row.frequency, what), value);
  };
  add("events per cycle", row.events);
  add("slipmode seconds per cycle, 600 cycles", row.long_seconds);
  add("slipmode seconds per cycle", row.slipmode.seconds);
  add("slipmode seconds per cycle, 600 cycles, audit off", row.plain_seconds);
  add("Adams seconds per cycle", row.peers[0].seconds);
  add("BDF seconds per cycle", row.peers[1].seconds);
  add("dopri5 seconds per cycle", row.peers[2].seconds);
  add("ratio to CVODE", row.ratio_cvode());
  add("ratio to odeint", row.ratio_odeint());
  add("slipmode error", median(row.slipmode.errors));
  add("Adams error", median(row.peers[0].errors));
  add("BDF error", median(row.peers[1].errors));
  add("dopri5 at 1e-12 seconds per cycle", row.tight.seconds);
  add("dopri5 at 1e-12 error", median(row.tight.errors));
  add("dopri5 error", median(row.peers[2].errors));
  out_row.timed.push_back({.name = fmt::format("beam {} {:g} Hz", row.model, row.frequency),
                           .ms = 1e7 * row.long_seconds,
                           .audit_on_off = row.long_seconds / row.plain_seconds,
                           .ratio_cvode = row.ratio_cvode(),
                           .ratio_dopri5 = row.ratio_odeint(),
                           .error = median(row.slipmode.errors)});
}

/// One sweep of a model; a line and figures.
void sweep(const BeamModel& model, const scene::Scene& scene, const std::vector<double>& frequencies, bool audit,
           Row& out_row) {
  diagnostics::DrivenSweepOptions options{
      .driven = {.cycles = kCycles, .flow = {.audit = audit}}, .parallel = {.threads = 2}, .sink = {}};
  const auto swept = diagnostics::driven_model(model.shaken, [&](double f) { return scene::drive_at(scene, f); });
  const double begin = wall_seconds(), cpu_begin = process_seconds();
  const auto result = diagnostics::driven_sweep(swept, frequencies, model.shaken.system.rest(), options);
  const double wall = wall_seconds() - begin, cpu = process_seconds() - cpu_begin;
  std::int64_t events = 0, failed = 0;
  double residual = 0.0;
  for (const auto& point : result.points) {
    if (!point.failure.empty()) {
      ++failed;
      continue;
    }
    events += point.settled.events;
    if (audit) residual = std::max(residual, std::abs(point.settled.audit_residual));
  }
  std::string text = fmt::format("{:<7}{:>5}{:9}{:12}{:10.2f}{:10.2f}{:>9}", model.name, audit ? "on" : "off",
                                 frequencies.size(), events, wall, cpu,
                                 audit ? fmt::format("{:.0f}", model.wanted.sweep_cpu_seconds / wanted_share()) : "-");
  if (audit) text += fmt::format("{:12.1e}", residual);
  if (failed > 0) text += fmt::format("   failed: {}", failed);
  out_row.lines.push_back(text);
  const std::string name = fmt::format("{} audit {}: ", model.name, audit ? "on" : "off");
  out_row.figures.emplace_back(name + "wall seconds", wall);
  out_row.figures.emplace_back(name + "CPU seconds", cpu);
  if (audit) out_row.timed.push_back({.name = "beam sweep " + model.name, .ms = 1e3 * cpu});
  if (audit) out_row.figures.emplace_back(name + "largest audit residual", residual);
}

}  // namespace

Row measure_beam(bool quick) {
  const scene::Scene scene = beam_scene();
  const std::vector<double> frequencies =
      quick ? std::vector{12.0, 41.1} : std::vector{8.0, 12.0, 20.0, 30.0, 41.1, 55.0};
  Row out;
  std::vector<BeamRow> rows;
  out.lines = {
      "CPU time in µs per cycle; left: 600 cycles, right: the stretches of the errors",
      fmt::format("{:<7}{:>6}{:>9}{:>10}{:>10}{:>6} |{:>9}{:>10}{:>10}{:>10}{:>10}{:>10}{:>9}{:>7}{:>8}{:>7}{:>8}{:>7}",
                  "beam", "Hz", "events", "slipmode", "audit off", "on/", "events", "slipmode", "Adams", "BDF",
                  "dopri5", "at 1e-12", "CVODE/", "wanted", "dopri5/", "wanted", "1e-12/", "wanted")};
  for (const BeamModel& model : beam_models(scene)) {
    for (const double frequency : frequencies) {
      rows.push_back(measure(model, scene, frequency));
      out.lines.push_back(line(rows.back()));
      add_figures(rows.back(), out);
    }
  }
  out.lines.emplace_back("");
  out.lines.emplace_back("errors: median, worst, events per cycle on the stretches");
  out.lines.push_back(fmt::format("{:<7}{:>6}{:>8}{:>26}{:>26}{:>26}{:>26}{:>26}", "beam", "Hz", "truth", "slipmode",
                                  "Adams", "BDF", "dopri5", "dopri5, 1e-12"));
  for (const BeamRow& row : rows) out.lines.push_back(error_line(row));
  return out;
}

Row measure_beam_sweep(std::size_t model, bool quick) {
  const scene::Scene scene = beam_scene();
  const std::vector<double> frequencies = diagnostics::sweep_values(5.0, 60.0, quick ? 1.0 : 0.1);
  const BeamModel chosen = beam_models(scene).at(model);
  Row out;
  out.lines = {"sweep  audit   values      events    wall s     CPU s   wanted    residual"};
  for (const bool audit : {true, false}) sweep(chosen, scene, frequencies, audit, out);
  return out;
}

}  // namespace slipmode::bench
