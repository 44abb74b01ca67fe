// Speed and accuracy beside the peers, measured in one process: see bench/README.md.
#include "bench/balance_cases.hpp"
#include "bench/basin_cases.hpp"
#include "bench/beam_cases.hpp"
#include "bench/cases.hpp"
#include "bench/extras_cases.hpp"
#include "bench/history.hpp"
#include "bench/kernel_cases.hpp"
#include "bench/library_cases.hpp"
#include "bench/long_chain_cases.hpp"
#include "bench/machine.hpp"
#include "bench/orbit_cases.hpp"
#include "bench/reduction_cases.hpp"
#include "bench/report.hpp"
#include "bench/series_cases.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

namespace {

using namespace slipmode::bench;

struct Request {
  std::vector<std::string> cases;
  std::string history;  ///< file; empty: none
  bool quick = false, json = false, all = false, compare = false;

  [[nodiscard]] bool names(const std::string& name) const {
    return std::find(cases.begin(), cases.end(), name) != cases.end();
  }
  [[nodiscard]] bool wants(const std::string& name) const { return cases.empty() || names(name); }
};

struct LibraryCase {
  std::string name;
  std::function<Row(bool quick)> measure;
  bool slow = false;  ///< only when named or with --all
};

std::vector<LibraryCase> library_cases() {
  return {{"kernels", measure_kernels},
          {"sweep-stribeck", [](bool quick) { return measure_sweep(false, quick); }},
          {"sweep-coulomb", [](bool quick) { return measure_sweep(true, quick); }},
          {"reduction", measure_reduction},
          {"orbit", measure_orbits},
          {"balance", measure_balances},
          {"basins", measure_basins},
          {"extras", measure_extras},
          {"chain10000", measure_long_chain, true},
          {"series", measure_series, true},
          {"pod", measure_pod, true},
          {"beam", measure_beam, true},
          {"beam-sweep-pomf", [](bool quick) { return measure_beam_sweep(0, quick); }, true},
          {"beam-sweep-lnm", [](bool quick) { return measure_beam_sweep(1, quick); }, true},
          {"beam-sweep-fe", [](bool quick) { return measure_beam_sweep(2, quick); }, true}};
}

std::vector<std::string> known_cases() {
  std::vector<std::string> names{"tanh"};
  for (const auto& c : comparison_cases(true)) names.push_back(c.problem.name);
  for (const auto& c : library_cases()) names.push_back(c.name);
  return names;
}

void say(const Request& request, const std::string& line) {
  std::FILE* stream = request.json ? stderr : stdout;
  fmt::print(stream, "{}\n", line);
  std::fflush(stream);
}

/// What is kept of every case: whether the machine was quiet meanwhile, a line of history, the change against it.
class Record {
 public:
  explicit Record(const Request& request) : request_(request) {
    if (!request.history.empty()) history_.emplace(request.history);
  }

  [[nodiscard]] const Machine& machine() const { return machine_; }

  /// Ends a case. @return  what to print behind its line: nothing where it was quiet
  std::string finish(const std::vector<Timed>& cases) {
    const Quietness quietness = watch_.lap();
    ++cases_;
    if (!quietness.quiet()) {
      ++disturbed_;
      loudest_ = std::max(loudest_, quietness.load);
    }
    for (Timed timed : cases) {
      if (request_.quick) timed.name += " quick";
      if (history_) history_->append(machine_, timed, quietness);
      if (history_ && request_.compare) changes_.push_back(history_->change(machine_, timed, quietness));
    }
    return quietness.quiet() ? "" : fmt::format("  not quiet: load {:.1f}", quietness.load);
  }

  /// One line on the whole run, then the changes.
  void close(nlohmann::json& out) const {
    const bool quiet = disturbed_ == 0;
    say(request_, quiet ? "\nThe machine was quiet."
                        : fmt::format("\nThe machine was not quiet in {} of {} cases: load up to {:.1f}.", disturbed_,
                                      cases_, loudest_));
    for (const std::string& line : changes_) say(request_, line);
    out["quiet"] = quiet;
    out["cases_disturbed"] = disturbed_;
    out["largest_load"] = loudest_;
  }

 private:
  const Request& request_;
  Machine machine_ = this_machine();
  Watch watch_;
  std::optional<History> history_;
  std::vector<std::string> changes_;
  int cases_ = 0, disturbed_ = 0;
  double loudest_ = 0.0;
};

void run_tanh(const Request& request, const Comparison& exact, Record& record, nlohmann::json& out) {
  say(request, "\n" + tanh_header());
  for (const double epsilon : {1e-2, 1e-3, 1e-4}) {
    const TanhFigures row = measure_tanh(exact, epsilon);
    say(request, tanh_line(row) + record.finish({}));
    out["tanh"].push_back(row);
  }
}

void run_comparisons(const Request& request, Record& record, nlohmann::json& out) {
  std::vector<Comparison> rows;
  for (const ComparisonCase& setting : comparison_cases(request.quick)) {
    const bool for_tanh = setting.problem.name == "stribeck10" && request.wants("tanh");
    if (!request.wants(setting.problem.name) && !for_tanh) continue;
    if (rows.empty()) say(request, time_header());
    rows.push_back(compare(setting));
    say(request, time_line(rows.back()) + record.finish({timed(rows.back())}));
    out["comparisons"].push_back(rows.back());
  }
  if (rows.empty()) return;
  say(request, "\n" + error_header());
  for (const Comparison& row : rows) say(request, error_line(row));
  if (request.wants("tanh")) run_tanh(request, rows.front(), record, out);
  say(request, "");
}

void run_library_cases(const Request& request, Record& record, nlohmann::json& out) {
  for (const LibraryCase& c : library_cases()) {
    if (!(request.names(c.name) || (request.cases.empty() && (request.all || !c.slow)))) continue;
    const Row row = c.measure(request.quick);
    for (const std::string& line : row.lines) say(request, line);
    if (const std::string disturbed = record.finish(row.timed); !disturbed.empty()) say(request, disturbed);
    for (const auto& [name, value] : row.figures) out[c.name][name] = value;
  }
}

nlohmann::json to_json(const Machine& m) {
  return {{"processor", m.processor}, {"threads", m.threads},   {"vectors", m.vectors},
          {"kernels", m.kernels},     {"compiler", m.compiler}, {"flags", m.flags},
          {"arch", m.arch},           {"commit", m.commit},     {"date", m.date}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("slipmode beside CVODE and Boost.odeint: time, error, events. Times are CPU time of one thread.");
  Request request;
  app.add_option("--case", request.cases, "only these rows")->check(CLI::IsMember(known_cases()));
  app.add_flag("--quick", request.quick, "a tenth of the simulated time, fewer repeats");
  app.add_flag("--all", request.all, "slow rows too (pod: a minute, 1 GiB; the beam: minutes)");
  auto* history = app.add_option("--history", request.history, "append a line per case to this CSV file");
  app.add_flag("--compare", request.compare, "print each case's change against the last quiet run in the history")
      ->needs(history);
  app.add_flag("--json", request.json, "one JSON object on standard output, the table on standard error");
  CLI11_PARSE(app, argc, argv);
  try {
    Record record(request);
    nlohmann::json out{{"machine", to_json(record.machine())}, {"quick", request.quick}};
    say(request, description(record.machine()) + "\n");
    run_comparisons(request, record, out);
    run_library_cases(request, record, out);
    record.close(out);
    if (request.json) fmt::print("{}\n", out.dump(2));
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "slipmode_bench: {}\n", error.what());
    return 3;
  }
}
