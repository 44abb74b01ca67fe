#include "bench/history.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace slipmode::bench {
namespace {

constexpr const char* kHeading =
    "date,commit,processor,kernels,case,ms,audit_on_off,ratio_cvode,ratio_dopri5,error,quiet";
constexpr std::size_t kColumns = 11;
/// Runs on a quiet machine differ by a few hundredths.
constexpr double kSlower = 1.05;

/// A text that is one field.
std::string field(std::string text) {
  for (char& c : text) {
    if (c == ',' || c == '"' || c == '\n') c = ' ';
  }
  return text;
}

std::string number(double value) { return value > 0.0 ? fmt::format("{:.5g}", value) : ""; }

HistoryRow parsed(const std::string& path, const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string one; std::getline(stream, one, ',');) fields.push_back(one);
  const auto bad = [&](const std::string& what) {
    return std::runtime_error(fmt::format("{}: expected {}, found '{}'", path, what, line));
  };
  if (fields.size() != kColumns) throw bad(fmt::format("{} fields", kColumns));
  const auto value = [&](std::size_t k) {
    try {
      return fields[k].empty() ? 0.0 : std::stod(fields[k]);
    } catch (const std::exception&) {
      throw bad(fmt::format("a number in field {}", k + 1));
    }
  };
  return {.date = fields[0],
          .commit = fields[1],
          .processor = fields[2],
          .kernels = fields[3],
          .timed = {.name = fields[4],
                    .ms = value(5),
                    .audit_on_off = value(6),
                    .ratio_cvode = value(7),
                    .ratio_dopri5 = value(8),
                    .error = value(9)},
          .quiet = fields[10]};
}

}  // namespace

History::History(std::string path) : path_(std::move(path)) {
  std::ifstream file(path_);
  std::string line;
  if (!std::getline(file, line)) return;
  if (line != kHeading) throw std::runtime_error(path_ + ": expected the heading " + kHeading + ", found " + line);
  while (std::getline(file, line)) before_.push_back(parsed(path_, line));
}

void History::append(const Machine& machine, const Timed& timed, const Quietness& quietness) const {
  const bool fresh = !std::ifstream(path_).good();
  std::ofstream file(path_, std::ios::app);
  if (fresh) file << kHeading << '\n';
  file << fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", machine.date, field(machine.commit),
                      field(machine.processor), field(machine.kernels), field(timed.name), number(timed.ms),
                      number(timed.audit_on_off), number(timed.ratio_cvode), number(timed.ratio_dopri5),
                      number(timed.error), field(quietness.text()));
  if (!file.flush()) throw std::runtime_error("cannot write " + path_);
}

std::string History::change(const Machine& machine, const Timed& timed, const Quietness& quietness) const {
  const auto last = std::find_if(before_.rbegin(), before_.rend(), [&](const HistoryRow& row) {
    return row.quiet == "quiet" && row.processor == field(machine.processor) && row.kernels == field(machine.kernels) &&
           row.timed.name == field(timed.name);
  });
  std::string text = fmt::format("{:<34} {:>10.3f} ms", timed.name, timed.ms);
  if (last == before_.rend()) return text + ", no quiet run before";
  const double ratio = timed.ms / last->timed.ms;
  text +=
      fmt::format(", {:.3f} at {} ({}): {:+.1f} %", last->timed.ms, last->commit, last->date, 100.0 * (ratio - 1.0));
  if (ratio > kSlower) text += quietness.quiet() ? "  SLOWER" : "  slower, but the machine was not quiet";
  return text;
}

}  // namespace slipmode::bench
