#include <slipmode/core/none.hpp>
#include <slipmode/results/sweep_store.hpp>
#include "cli/exponents_report.hpp"
#include "cli/text_table.hpp"
#include "cli/validation_report.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>

namespace slipmode::cli {
namespace {

using diagnostics::CandidateReport;
using diagnostics::OrbitRow;
using diagnostics::ShareRow;
using diagnostics::ValidationReport;

/// "period 5", or the kind of motion as its exponent tells it.
std::string attractor_text(const diagnostics::Settled& settled,
                           const std::optional<diagnostics::LyapunovExponent>& exponent) {
  const bool periodic = settled.period.motion == diagnostics::Motion::kPeriodic;
  return periodic ? results::motion_text(settled.period) : diagnostics::attractor_word(settled, exponent);
}

std::vector<std::string> share_cells(const ShareRow& row) {
  const bool ok = row.failure.empty();
  return {fixed(row.energy, 2),
          fixed(ok ? row.horizon.dX : kNone, 2),
          fixed(ok ? row.horizon.dE : kNone, 2),
          significant(row.attractor ? row.distance.wasserstein : kNone, 3),
          row.attractor ? attractor_text(*row.attractor, row.lyapunov) : "failed",
          significant(row.lyapunov ? row.lyapunov->bits : kNone, 3)};
}

/// A reason without its numbers, which differ from case to case.
std::string kind_of(std::string reason) {
  std::erase_if(reason, [](char c) { return c >= '0' && c <= '9'; });
  return reason;
}

/// Why something failed: one example of each kind of reason, with how often it was met.
class Failures {
 public:
  void add(const std::string& reason, const std::string& of) {
    auto& [example, times] = kinds_[kind_of(reason)];
    if (times++ == 0) example = fmt::format("{}: {}", of, reason);
  }
  /// @param word  that stands for it in a table
  [[nodiscard]] std::string text(const char* word) const {
    std::string out;
    for (const auto& [kind, met] : kinds_) {
      const auto& [example, times] = met;
      out += fmt::format("  {}{} {}\n", word, times == 1 ? ":" : fmt::format(", {} times: e.g.", times), example);
    }
    return out;
  }

 private:
  std::map<std::string, std::pair<std::string, int>> kinds_;
};

/// One row per number of modes, all bases side by side.
std::string shares_text(const ValidationReport& report) {
  std::vector<std::string> header = {"modes"};
  for (std::size_t c = 0; c < report.candidates.size(); ++c) {
    header.insert(header.end(), {"energy %", "ΔX %", "ΔE %", "W", "motion", "λ"});
  }
  TextTable table(header);
  table.group("", 1);
  for (const CandidateReport& candidate : report.candidates) table.group(candidate.name, 6);
  for (std::size_t i = 0; i < report.candidates.front().shares.size(); ++i) {
    std::vector<std::string> cells = {fmt::format("{}", report.candidates.front().shares[i].modes)};
    for (const CandidateReport& candidate : report.candidates) {
      const std::vector<std::string> more = share_cells(candidate.shares[i]);
      cells.insert(cells.end(), more.begin(), more.end());
    }
    table.add(cells);
  }
  Failures failures;
  for (const CandidateReport& candidate : report.candidates) {
    for (const ShareRow& row : candidate.shares) {
      if (!row.failure.empty()) failures.add(row.failure, fmt::format("{} {}s", row.modes, candidate.name));
    }
  }
  return table.str() + failures.text("failed");
}

/// ΔX and ΔE where both have the same period, else what the reduced model does instead.
std::vector<std::string> orbit_cells(const OrbitRow& row) {
  if (!row.comparison) return {"none", ""};
  const auto& comparison = *row.comparison;
  if (!comparison.same_period) return {fmt::format("period {}", comparison.reduced.period), ""};
  return {fixed(comparison.deviation.dX, 2), fixed(comparison.deviation.dE, 2)};
}

/// The orbits of one speed: rows of all bases, by number of modes.
struct SpeedOrbits {
  double speed = 0.0;
  int period = 0;  ///< of the full model; 0: no reduced model was compared
  std::vector<std::vector<const OrbitRow*>> rows;
};

std::vector<SpeedOrbits> orbits_by_speed(const ValidationReport& report) {
  std::vector<SpeedOrbits> out;
  const std::size_t levels = report.candidates.front().shares.size();
  const std::size_t speeds = levels == 0 ? 0 : report.candidates.front().orbits.size() / levels;
  for (std::size_t s = 0; s < speeds; ++s) {
    SpeedOrbits at;
    for (std::size_t i = 0; i < levels; ++i) {
      at.rows.emplace_back();
      for (const CandidateReport& candidate : report.candidates) {
        const OrbitRow& row = candidate.orbits[s * levels + i];
        at.speed = row.speed;
        if (row.comparison) at.period = row.comparison->full.period;
        at.rows.back().push_back(&row);
      }
    }
    out.push_back(std::move(at));
  }
  return out;
}

/// Why there is no orbit: one example of each kind of reason, with how often it was met.
std::string orbit_failures(const ValidationReport& report) {
  Failures failures;
  for (const CandidateReport& candidate : report.candidates) {
    for (const OrbitRow& row : candidate.orbits) {
      if (row.failure.empty()) continue;
      failures.add(row.failure, fmt::format("{} {}s at V = {:g}", row.modes, candidate.name, row.speed));
    }
  }
  return failures.text("none");
}

std::string orbits_text(const ValidationReport& report) {
  const std::vector<SpeedOrbits> speeds = orbits_by_speed(report);
  std::vector<std::string> header = {"modes"};
  for (std::size_t s = 0; s < speeds.size(); ++s) {
    for (const CandidateReport& candidate : report.candidates) {
      header.push_back(candidate.name + " ΔX %");
      header.emplace_back("ΔE %");
    }
  }
  TextTable table(header);
  table.group("", 1);
  for (const SpeedOrbits& at : speeds) {
    const std::string period = at.period > 0 ? fmt::format("period {}", at.period) : "no orbit";
    table.group(fmt::format("V = {:g}, {}", at.speed, period), 2 * report.candidates.size());
  }
  for (std::size_t i = 0; i < report.candidates.front().shares.size(); ++i) {
    std::vector<std::string> cells = {fmt::format("{}", report.candidates.front().shares[i].modes)};
    for (const SpeedOrbits& at : speeds) {
      for (const OrbitRow* row : at.rows[i]) {
        const std::vector<std::string> more = orbit_cells(*row);
        cells.insert(cells.end(), more.begin(), more.end());
      }
    }
    table.add(cells);
  }
  return table.str() + orbit_failures(report);
}

std::string sweep_text(const ValidationReport& report, const results::Units& units) {
  std::map<std::string, std::size_t> reduced;
  TextTable table({"motion", "full", "reduced"});
  for (const results::MotionCount& count : results::count_motions(report.sweep->reduced))
    reduced[count.motion] = count.values;
  for (const results::MotionCount& count : results::count_motions(report.sweep->full)) {
    table.add({count.motion, fmt::format("{}", count.values), fmt::format("{}", reduced[count.motion])});
    reduced.erase(count.motion);
  }
  for (const results::MotionCount& count : results::count_motions(report.sweep->reduced)) {
    if (reduced.contains(count.motion)) table.add({count.motion, "0", fmt::format("{}", count.values)});
  }
  const std::string note = results::undecided_note(report.sweep->full, units);
  return table.str() + (note.empty() ? results::undecided_note(report.sweep->reduced, units) : note);
}

/// What the table's columns are, and how far two runs of the full model are apart in them.
std::string noise_text(const ValidationReport& report, const results::Units& units) {
  constexpr double kSameMotion = 10.0;  // % of the mean energy
  const double apart = std::abs(report.noise.mean_energy_percent);
  std::string out = fmt::format(
      "Reduced models at that speed: ΔX, ΔE over the horizon from shared starts; W: distance of the slip "
      "states of\nthe settled motions{} (two full runs: {}, mean energies {} % apart); λ: largest "
      "exponent",
      units.length == "1" ? "" : fmt::format(" [{}]", units.length), significant(report.noise.wasserstein, 3),
      significant(apart, 2));
  double largest = 0.0;
  for (const CandidateReport& candidate : report.candidates) {
    for (const ShareRow& row : candidate.shares) {
      if (row.lyapunov) largest = std::max(largest, row.lyapunov->error_bits());
    }
  }
  out += largest > 0.0 ? fmt::format(" [{}], ± {:.1g} at most\n", units.bit_rate(), largest) : "\n";
  if (apart > kSameMotion) {
    out += "  The two full runs differ by more than that of one motion: there are several, or they are not settled\n";
  }
  return out;
}

}  // namespace

std::string summary_text(const ValidationReport& report, const results::Units& units) {
  std::string out =
      fmt::format("Full model at V = {:g}: {}", report.speed, attractor_text(report.full, report.lyapunov));
  if (report.lyapunov) {
    out += fmt::format(", largest exponent {:.3g} ± {:.1g} {}", report.lyapunov->bits, report.lyapunov->error_bits(),
                       units.bit_rate());
  }
  out += fmt::format(", sticks {:.1f} % of the time\n", 100.0 * report.full.stick_fraction) + noise_text(report, units);
  out += shares_text(report);
  if (report.left_out_above > 0) {
    out += fmt::format(
        "  left out: more than {} modes, as W of the last two rows is within three times that of two full runs;\n"
        "  [validation] modes brings them\n",
        report.left_out_above);
  }
  if (!report.candidates.front().orbits.empty()) {
    out += "\nPeriodic orbits: deviation over one period where the periods are the same\n" + orbits_text(report);
  }
  if (report.sweep && report.bifurcation) {
    out +=
        fmt::format("\nBelt-speed sweep: {} values, full model and {} {}s, in {:.2f} s\n{}", report.sweep->full.size(),
                    report.chosen, report.candidates.front().name, report.sweep_wall, sweep_text(report, units));
    const auto& both = *report.bifurcation;
    out += fmt::format(
        "  decided in both models: {} of {} values{}; median distance of slip states {}\n", both.decided,
        report.sweep->full.size(),
        both.decided > 0 ? fmt::format(", same period at {:.1f} % of these", 100.0 * both.same_period) : std::string(),
        significant(both.median_wasserstein, 3));
  }
  if (report.verdict) out += fmt::format("\n{}", verdict_text(*report.verdict, true));
  if (report.cost) {
    const auto& cost = *report.cost;
    out += fmt::format("\nOne run of {:g} {}: full {:.3f} ms, {} {}s {:.3f} ms, speed-up {:.2f}\n", cost.duration,
                       units.times(), 1e3 * cost.full_wall, report.chosen, report.candidates.front().name,
                       1e3 * cost.reduced_wall, cost.full_wall / cost.reduced_wall);
  }
  return out;
}

}  // namespace slipmode::cli
