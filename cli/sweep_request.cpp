#include "cli/sweep_request.hpp"

#include <slipmode/core/numbers.hpp>
#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/results/journal.hpp>

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {

studies::Over parse_over(const std::string& text) {
  const auto complain = [&text](const std::string& what) {
    return InvalidInput(
        fmt::format("--over {}: {}; expected KEY=FROM:TO:STEP, e.g. drive.speed=0.5:0.001:0.001", text, what));
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw complain("no KEY=");
  std::vector<double> numbers;
  for (std::size_t begin = equals + 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const auto value = number_in<double>(word);
    if (!value) throw complain(fmt::format("'{}' is not a number", word));
    numbers.push_back(*value);
    begin = end + 1;
  }
  if (numbers.size() != 3) throw complain(fmt::format("{} numbers found", numbers.size()));
  return {text.substr(0, equals), diagnostics::sweep_values(numbers[0], numbers[1], numbers[2])};
}

Report interrupted_at(const std::string& output, const std::string& how_far) {
  Report report;
  report.exit_code = kInterrupted;
  report.text = fmt::format("interrupted{}{}; what is done is kept in {}\nThe same command goes on from there.",
                            how_far.empty() ? "" : " ", how_far, results::Journal::path_for(output).string());
  report.data = {{"message", report.text}};
  return report;
}

}  // namespace slipmode::cli
