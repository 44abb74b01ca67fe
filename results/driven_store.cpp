#include <slipmode/results/driven_store.hpp>

#include <slipmode/core/none.hpp>
#include <slipmode/results/table.hpp>
#include "results/internal/journal_line.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <functional>
#include <map>
#include <utility>

namespace slipmode::results {
namespace {

using diagnostics::DrivenMotion;
using diagnostics::DrivenPoint;
using diagnostics::DrivenRepeat;

void list_motion(detail::Line& line, DrivenPoint& point) {
  DrivenMotion& own = point.settled;
  line(own.frequency_hz, own.label, own.period.repeat, own.period.period, own.period.mismatch, own.stick_fraction,
       own.longest_stick, own.separations, own.jumps, own.events, own.mean_energy, own.audit_residual, own.readings,
       own.contact_q, own.contact_v, own.mean, own.rms, own.exponent, own.end);
}

/// The columns of `values`, filled point by point.
class ValueTable {
 public:
  ValueTable(const DrivenAxes& axes, const Units& units) {
    number("parameter", axes.swept.units, axes.swept.key, [](const DrivenPoint& p) { return p.parameter; });
    text("label", "stick, stick-slip, slip, no friction, or failed",
         [](const DrivenMotion& m) { return std::string(diagnostics::to_string(m.label)); });
    text("repeat", "periodic, settling, aperiodic, undecided, or failed",
         [](const DrivenMotion& m) { return std::string(diagnostics::to_string(m.period.repeat)); });
    motion("period", "", "drive periods after which sections repeat, or approach repeating; 0: never",
           [](const DrivenMotion& m) { return static_cast<double>(m.period.period); });
    motion("mean", axes.reading_unit, "mean of the " + axes.reading, [](const DrivenMotion& m) { return m.mean(0); });
    motion("rms", axes.reading_unit, "root mean square about the mean of the " + axes.reading,
           [](const DrivenMotion& m) { return m.rms(0); });
    motion("stick_fraction", "1", "share of time in stick, mean over contacts whose law sticks, micro-stick included",
           [](const DrivenMotion& m) { return m.stick_fraction; });
    motion("longest_stick", "1", "longest stick, in drive periods",
           [](const DrivenMotion& m) { return m.longest_stick; });
    motion("separations", "", "losses of contact", [](const DrivenMotion& m) { return double(m.separations); });
    motion("jumps", "", "jumps of contact points", [](const DrivenMotion& m) { return double(m.jumps); });
    motion("mean_energy", units.energy, "mean energy", [](const DrivenMotion& m) { return m.mean_energy; });
    motion("exponent", units.rate, "largest Lyapunov exponent; NaN: not asked for",
           [](const DrivenMotion& m) { return m.exponent ? m.exponent->nats : kNone; });
    motion("exponent_error", units.rate, "its standard error",
           [](const DrivenMotion& m) { return m.exponent ? m.exponent->error : kNone; });
    motion("events", "", "events located in all cycles", [](const DrivenMotion& m) { return double(m.events); });
    motion("audit_residual", "1", "energy balance relative to the energy exchanged",
           [](const DrivenMotion& m) { return m.audit_residual; });
  }

  Table filled(const std::vector<DrivenPoint>& points) const {
    Table table{"one row per value of the key; times and counts are those of the cycles kept", {}};
    for (const Number& column : numbers_)
      table.columns.push_back({column.name, column.meaning, of_each<double>(points, column.get)});
    for (const Text& column : texts_) {
      const auto text = [&column](const DrivenPoint& point) {
        return point.ok() ? column.get(point.settled) : std::string("failed");
      };
      table.columns.push_back({column.name, column.meaning, of_each<std::string>(points, text)});
    }
    const auto failure = [](const DrivenPoint& point) { return point.failure; };
    table.columns.push_back(
        {"failure", {"", "why the value failed; empty: it did not"}, of_each<std::string>(points, failure)});
    return table;
  }

 private:
  /// What each point says.
  template <class T, class Get>
  static std::vector<T> of_each(const std::vector<DrivenPoint>& points, const Get& get) {
    std::vector<T> values;
    values.reserve(points.size());
    for (const DrivenPoint& point : points) values.push_back(get(point));
    return values;
  }
  struct Number {
    std::string name;
    Meaning meaning;
    std::function<double(const DrivenPoint&)> get;
  };
  struct Text {
    std::string name;
    Meaning meaning;
    std::function<std::string(const DrivenMotion&)> get;
  };

  void number(std::string name, std::string unit, std::string what, std::function<double(const DrivenPoint&)> get) {
    numbers_.push_back({std::move(name), {std::move(unit), std::move(what)}, std::move(get)});
  }
  void motion(std::string name, std::string unit, std::string what, std::function<double(const DrivenMotion&)> get) {
    number(std::move(name), std::move(unit), std::move(what),
           [get = std::move(get)](const DrivenPoint& point) { return point.ok() ? get(point.settled) : kNone; });
  }
  void text(std::string name, std::string what, std::function<std::string(const DrivenMotion&)> get) {
    texts_.push_back({std::move(name), {"", std::move(what)}, std::move(get)});
  }

  std::vector<Number> numbers_;
  std::vector<Text> texts_;
};

}  // namespace

diagnostics::DrivenSink driven_journal_sink(Journal& journal) {
  return detail::table_sink<DrivenMotion>(journal, "driven", list_motion);
}

void store_driven(StoreWriter& writer, const std::string& group, const std::string& title, const DrivenAxes& axes,
                  const Units& units, const std::vector<DrivenPoint>& points, SectionDetail detail) {
  writer.describe_group(group, title);
  writer.write(group + "/title", title, {"", "which model"});
  writer.write(group + "/key", axes.swept.key, {"", "the scene's key that was swept"});
  writer.write(group + "/label", axes.swept.label, {"", "name of the key for an axis"});
  writer.write(group + "/reading", axes.reading, {"", "what is read at the sections"});
  save(writer, group + "/values", ValueTable(axes, units).filled(points));
  std::vector<double> parameter, reading, displacement, velocity;
  for (const DrivenPoint& point : points) {
    for (Eigen::Index k = 0; k < point.settled.readings.cols(); ++k) {
      parameter.push_back(point.parameter);
      reading.push_back(point.settled.readings(0, k));
      displacement.push_back(point.settled.contact_q(0, k));
      velocity.push_back(point.settled.contact_v(0, k));
    }
  }
  Table sections{"one row per section kept: the slider's velocity passes zero upward, a force begins a turn",
                 {{"parameter", {axes.swept.units, axes.swept.key}, parameter},
                  {"reading", {axes.reading_unit, axes.reading}, reading}}};
  if (detail == SectionDetail::kAll) {
    sections.columns.push_back({"displacement", {units.length, "displacement of the first contact"}, displacement});
    sections.columns.push_back({"velocity", {units.velocity, "velocity of the first contact"}, velocity});
  }
  save(writer, group + "/sections", sections);
}

std::string motion_text(const DrivenMotion& motion) {
  const auto& period = motion.period;
  const std::string repeat = period.repeat == DrivenRepeat::kPeriodic ? fmt::format("period {}", period.period)
                             : period.repeat == DrivenRepeat::kSettling
                                 ? fmt::format("settling to period {}", period.period)
                                 : diagnostics::to_string(period.repeat);
  return fmt::format("{}, {}{}", diagnostics::to_string(motion.label), repeat,
                     motion.separations > 0 ? ", contact lost" : "");
}

std::string unsettled_note(const std::vector<DrivenPoint>& points, double cycles) {
  const bool any = std::ranges::any_of(points, [](const DrivenPoint& point) {
    const auto repeat = point.settled.period.repeat;
    return point.ok() && (repeat == DrivenRepeat::kSettling || repeat == DrivenRepeat::kUndecided);
  });
  if (!any) return {};
  return fmt::format("  settling, or undecided, after {0:g} cycles; to wait longer: --set validation.cycles={1:g}\n",
                     cycles, 10.0 * cycles);
}

std::vector<MotionCount> count_motions(const std::vector<DrivenPoint>& points) {
  std::map<std::string, std::size_t> counts;
  for (const DrivenPoint& point : points) ++counts[point.ok() ? motion_text(point.settled) : "failed"];
  std::vector<MotionCount> out;
  out.reserve(counts.size());
  for (const auto& [motion, values] : counts) out.push_back({motion, values});
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.values > b.values; });
  return out;
}

std::string peaks_text(const std::vector<diagnostics::AmplitudePeak>& peaks) {
  std::string out;
  for (const auto& peak : peaks) {
    out += fmt::format("{}{:g} ({:.3g})", out.empty() ? "" : ", ", peak.parameter, peak.amplitude);
  }
  return out.empty() ? "none" : out;
}

}  // namespace slipmode::results
