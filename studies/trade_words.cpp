#include <slipmode/studies/trade_words.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <charconv>
#include <optional>

namespace slipmode::studies {
namespace {

/// A positive number and what follows it, blanks in between left out.
struct Quantity {
  double number = 0.0;
  std::string unit;
};

std::optional<Quantity> read_quantity(const std::string& text) {
  Quantity found;
  const auto [stopped, error] = std::from_chars(text.data(), text.data() + text.size(), found.number);
  if (error != std::errc() || !(found.number > 0.0)) return std::nullopt;
  found.unit = std::string(stopped, text.data() + text.size());
  found.unit.erase(0, found.unit.find_first_not_of(' '));
  return found;
}

}  // namespace

double parse_percent(const std::string& option, const std::string& text) {
  const auto found = read_quantity(text);
  if (found && found->unit.empty() && found->number < 1.0) {  // as other options have shares
    throw InvalidInput(fmt::format("{0} {1}: write {1}% or {2}%, whichever is meant", option, text,
                                   fmt::format("{:.6g}", 100.0 * found->number)));
  }
  if (found && (found->unit.empty() || found->unit == "%")) return found->number;
  throw InvalidInput(fmt::format("{} {}: expected a share in percent, e.g. 1%", option, text));
}

double parse_duration(const std::string& option, const std::string& text) {
  const auto found = read_quantity(text);
  if (found && (found->unit.empty() || found->unit == "s")) return found->number;
  if (found && found->unit == "ms") return 1e-3 * found->number;
  if (found && found->unit == "min") return 60.0 * found->number;
  throw InvalidInput(fmt::format("{} {}: expected a time in s, ms or min, e.g. 10s", option, text));
}

trade::Measure parse_measure(const std::string& word) {
  std::string valid;
  for (std::size_t m = 0; m < trade::kMeasures; ++m) {
    const auto measure = static_cast<trade::Measure>(m);
    if (trade::to_string(measure) == word) return measure;
    valid += (valid.empty() ? "" : ", ") + std::string(trade::to_string(measure));
  }
  throw InvalidInput(fmt::format("--measure {}: no such measure; valid: {}", word, valid));
}

}  // namespace slipmode::studies
