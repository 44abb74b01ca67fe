// Speed and accuracy beside the peers, measured in one process: see bench/README.md.
#include "bench/cases.hpp"
#include "bench/report.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>

namespace {

using namespace slipmode::bench;

struct Request {
  std::vector<std::string> cases;
  bool quick = false, json = false, list = false;

  [[nodiscard]] bool wants(const std::string& name) const {
    return cases.empty() || std::find(cases.begin(), cases.end(), name) != cases.end();
  }
};

void say(const Request& request, const std::string& line) {
  std::FILE* stream = request.json ? stderr : stdout;
  fmt::print(stream, "{}\n", line);
  std::fflush(stream);
}

void run_comparisons(const Request& request, nlohmann::json& out) {
  std::vector<Comparison> for_tanh;
  bool headed = false;
  for (const ComparisonCase& setting : comparison_cases(request.quick)) {
    const bool tanh = setting.problem.name == "stribeck10" && request.wants("tanh");
    if (!request.wants(setting.problem.name) && !tanh) continue;
    if (!headed) say(request, comparison_header());
    headed = true;
    const Comparison row = compare(setting);
    say(request, comparison_line(row));
    out["comparisons"].push_back(row);
    if (tanh) for_tanh.push_back(row);
  }
  if (!for_tanh.empty()) say(request, "\n" + tanh_header());
  for (const Comparison& exact : for_tanh) {
    for (const double epsilon : {1e-2, 1e-3, 1e-4}) {
      const TanhFigures row = measure_tanh(exact, epsilon);
      say(request, tanh_line(row));
      out["tanh"].push_back(row);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("slipmode beside CVODE and Boost.odeint: time, error, events. Times are CPU time of one thread.");
  Request request;
  app.add_option("--case", request.cases, "only these rows (may be repeated)");
  app.add_flag("--quick", request.quick, "a tenth of the simulated time, fewer repeats");
  app.add_flag("--json", request.json, "one JSON object on standard output, the table on standard error");
  CLI11_PARSE(app, argc, argv);
  try {
    nlohmann::json out{{"cpu", cpu_model()}, {"quick", request.quick}};
    say(request, cpu_model());
    run_comparisons(request, out);
    if (request.json) fmt::print("{}\n", out.dump(2));
  } catch (const std::exception& error) {
    fmt::print(stderr, "slipmode_bench: {}\n", error.what());
    return 3;
  }
  return 0;
}
