#include <slipmode/studies/command.hpp>

#include <slipmode/core/numbers.hpp>
#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/results/journal.hpp>

#include <algorithm>
#include <cmath>

namespace slipmode::studies {
namespace {

/// FROM:TO:STEP with end and step to twelve digits, as somebody would have written them.
std::optional<std::string> range_text(const std::vector<double>& values) {
  if (values.size() < 2) return fmt::format("{0}:{0}:1", values.front());
  const std::string to = fmt::format("{:.12g}", values.back()),
                    step = fmt::format("{:.12g}", std::abs(values[1] - values[0]));
  const double stride = *number_in<double>(step), end = *number_in<double>(to);
  const double count = std::abs(end - values.front()) / stride + 1.0;
  if (!(std::abs(count - static_cast<double>(values.size())) < 0.5)) return std::nullopt;
  if (diagnostics::sweep_values(values.front(), end, stride) != values) return std::nullopt;
  return fmt::format("{}:{}:{}", values.front(), to, step);
}

}  // namespace

std::string over_text(const Over& over) {
  const auto& values = over.values;
  if (values.empty()) return over.key;
  if (const auto range = range_text(values)) return fmt::format("{}={}", over.key, *range);
  const std::string bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  return fmt::format("{}={} values {}...{} ({})", over.key, values.size(), values.front(), values.back(),
                     results::fingerprint(bytes));
}

std::string option_name(const char* field) {
  std::string name = std::string("--") + field;
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

std::string model_option(const std::string& model) { return model == "full" ? "" : " --model " + model; }

std::string command_text(const std::string& verb, const std::vector<Over>& over, const std::string& options) {
  std::string text = "slipmode " + verb;
  for (const Over& one : over) text += " --over " + over_text(one);
  return text + options;
}

}  // namespace slipmode::studies
