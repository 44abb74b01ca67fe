#include "cli/sweep_request.hpp"

#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/results/journal.hpp>

#include <fmt/format.h>
#include <charconv>
#include <fstream>
#include <iterator>

namespace slipmode::cli {

Over parse_over(const std::string& text) {
  const auto complain = [&text](const std::string& what) {
    return InvalidInput(
        fmt::format("--over {}: {}; expected KEY=FROM:TO:STEP, e.g. drive.speed=0.5:0.001:0.001", text, what));
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw complain("no KEY=");
  std::vector<double> numbers;
  for (std::size_t begin = equals + 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    double value = 0.0;
    const auto [stopped, error] = std::from_chars(text.data() + begin, text.data() + end, value);
    if (error != std::errc() || stopped != text.data() + end) {
      throw complain(fmt::format("'{}' is not a number", text.substr(begin, end - begin)));
    }
    numbers.push_back(value);
    begin = end + 1;
  }
  if (numbers.size() != 3) throw complain(fmt::format("{} numbers found", numbers.size()));
  return {text.substr(0, equals), diagnostics::sweep_values(numbers[0], numbers[1], numbers[2])};
}

std::string file_fingerprint(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return results::fingerprint({std::istreambuf_iterator<char>(in), {}});
}

void require_belt_request(const SweepRequest& request) {
  if (!request.reverse && !request.both && request.exponent_cycles == 0.0) return;
  throw InvalidInput(
      "--reverse, --both and --lyapunov are for scenes with a shaker; a belt's sweep runs from FROM to TO");
}

void check_values(const scene::Scene& scene, const Over& over) {
  for (const double value : over.values) {
    const scene::Scene changed = scene::set_key(scene, over.key, value);
    if (changed.size() == scene.size()) continue;
    throw InvalidInput(
        fmt::format("--over {}: the number of degrees of freedom must stay at {} along a sweep, value {} "
                    "changes it; run one sweep per size with --set",
                    over.key, scene.size(), value));
  }
}

Report interrupted_sweep(const SweepRequest& request, const Over& over, std::size_t finished) {
  const std::size_t values = over.values.size() * (request.both ? 2 : 1);
  Report report;
  report.exit_code = kInterrupted;
  report.text = fmt::format(
      "interrupted with {} of {} values done; they are kept in {}\nThe same command goes on from "
      "there.",
      finished, values, results::Journal::path_for(request.output).string());
  report.data = {{"verb", "sweep"}, {"finished", finished}, {"values", values}, {"message", report.text}};
  return report;
}

}  // namespace slipmode::cli
