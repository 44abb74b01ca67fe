#include <slipmode/results/map_store.hpp>

#include <slipmode/core/none.hpp>
#include "results/internal/journal_line.hpp"

#include <fmt/format.h>
#include <functional>
#include <sstream>
#include <utility>

namespace slipmode::results {
namespace {

using orbits::MapPoint;
using orbits::StrobePoint;

/// Failures of a row, one line per point; lines of points that went well are empty.
std::string failure_lines(const std::vector<MapPoint>& row) {
  std::string text;
  bool any = false;
  for (const MapPoint& point : row) {
    text += point.failure + '\n';
    any = any || !point.failure.empty();
  }
  return any ? text : std::string();
}

void list(detail::Line& line, MapPoint& point) {
  line(point.order, point.crossings, point.multiplier, point.symmetric, point.floating, point.alternating,
       point.residual, point.periods);
}

void list(detail::Line& line, StrobePoint& point) {
  line(point.parameter, point.order, point.mismatch, point.section, point.alternating, point.effective, point.end);
}

JournalRecord to_record(const std::string& table, std::size_t row, std::vector<MapPoint> points) {
  detail::Line line;
  std::size_t size = points.size();
  line(size);
  for (MapPoint& point : points) list(line, point);
  return {table, static_cast<std::int64_t>(row), line.written(), failure_lines(points)};
}

std::vector<MapPoint> row_from_record(const JournalRecord& record) {
  detail::Line line(record);
  std::size_t size = 0;
  line(size);
  std::vector<MapPoint> row(size);
  std::istringstream failures(record.note);
  for (MapPoint& point : row) {
    list(line, point);
    std::getline(failures, point.failure);
  }
  return row;
}

JournalRecord to_record(const std::string& table, std::size_t index, StrobePoint point) {
  detail::Line line;
  list(line, point);
  return {table, static_cast<std::int64_t>(index), line.written(), point.failure};
}

StrobePoint point_from_record(const JournalRecord& record) {
  StrobePoint point;
  detail::Line line(record);
  list(line, point);
  point.failure = record.note;
  return point;
}

/// Records of one table by index.
template <class Value, class Read>
detail::Kept<Value, std::size_t> recorded(const Journal& journal, const std::string& table, const Read& read) {
  detail::Kept<Value, std::size_t> kept;
  for (const JournalRecord& record : journal.records()) {
    if (record.table == table) kept.keep({static_cast<std::size_t>(record.index)}, read(record));
  }
  return kept;
}

void store_axis(StoreWriter& writer, const std::string& group, const SweepAxis& axis,
                const std::vector<double>& values) {
  writer.write(group + "/key", axis.key, {"", "the scene's key"});
  writer.write(group + "/label", axis.label, {"", "name of the key for an axis"});
  writer.write(group + "/values", values, {axis.units, axis.key});
}

/// One number of every point [y x x].
Eigen::MatrixXd layer(const orbits::OrbitMap& map, std::size_t columns,
                      const std::function<double(const MapPoint&)>& number) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(map.rows.size()), static_cast<Eigen::Index>(columns));
  for (std::size_t j = 0; j < map.rows.size(); ++j) {
    for (std::size_t i = 0; i < columns; ++i) {
      values(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) = number(map.rows[j][i]);
    }
  }
  return values;
}

void store_failures(StoreWriter& writer, const std::string& group, const orbits::MapGrid& grid,
                    const orbits::OrbitMap& map) {
  std::vector<double> x, y;
  std::vector<std::string> text;
  for (std::size_t j = 0; j < map.rows.size(); ++j) {
    for (std::size_t i = 0; i < map.rows[j].size(); ++i) {
      if (map.rows[j][i].failure.empty()) continue;
      x.push_back(grid.x[i]);
      y.push_back(grid.y[j]);
      text.push_back(map.rows[j][i].failure);
    }
  }
  save(writer, group,
       Table{"points at which the flow failed",
             {{"x", {"", "value of the first key"}, x},
              {"y", {"", "value of the second key"}, y},
              {"failure", {"", "why"}, text}}});
}

}  // namespace

orbits::MapSink map_sink(Journal& journal, const std::string& start) {
  return {.recall = recorded<std::vector<MapPoint>>(journal, start, row_from_record),
          .store = [&journal, start](std::size_t row, const std::vector<MapPoint>& points) {
            journal.append(to_record(start, row, points));
          }};
}

orbits::StrobeSink strobe_sink(Journal& journal, const std::string& start) {
  return {.recall = recorded<StrobePoint>(journal, start, point_from_record),
          .store = [&journal, start](std::size_t index, const StrobePoint& point) {
            journal.append(to_record(start, index, point));
          }};
}

void store_map(StoreWriter& writer, const SweepAxis& x, const SweepAxis& y, const orbits::MapGrid& grid,
               const std::vector<StartedMap>& maps, const std::string& length_unit) {
  const std::string root = kMapGroup;
  writer.describe_group(root, "settled periodic orbits over two keys; datasets are y x x");
  store_axis(writer, root + "/x", x, grid.x);
  store_axis(writer, root + "/y", y, grid.y);
  for (const StartedMap& started : maps) {
    const std::string group = root + "/from_" + started.start;
    writer.describe_group(group, started.start == "centre" ? "from the steady linear motion in the middle of the gap"
                                                           : "from the scene's initial state");
    const auto write = [&](const std::string& name, const Meaning& meaning, auto number) {
      writer.write(group + "/" + name, layer(started.map, grid.x.size(), number), meaning);
    };
    write("order", {"", "period in periods of the drive; 0: not periodic"}, [](const MapPoint& p) { return p.order; });
    write("crossings", {"", "changes of force law in a period; 0 also where not periodic"},
          [](const MapPoint& p) { return p.crossings; });
    write("multiplier", {"1", "largest |multiplier|; NaN: not periodic"},
          [](const MapPoint& p) { return p.multiplier; });
    write("symmetric", {"", "1: x(T/2) = -x(0)"}, [](const MapPoint& p) { return p.symmetric ? 1.0 : 0.0; });
    write("floating", {"", "1: one of a family of orbits"}, [](const MapPoint& p) { return p.floating ? 1.0 : 0.0; });
    write("alternating", {length_unit, "(max - min)/2 of the first contact's displacement; NaN: not periodic"},
          [](const MapPoint& p) { return p.alternating; });
    write("residual", {"1", "mismatch of the orbit after its period"}, [](const MapPoint& p) { return p.residual; });
    write("periods", {"", "periods of the drive simulated"}, [](const MapPoint& p) { return p.periods; });
    store_failures(writer, group + "/failures", grid, started.map);
  }
}

void store_strobe(StoreWriter& writer, const SweepAxis& axis, const std::vector<StartedStrobe>& runs,
                  const std::string& length_unit) {
  const std::string root = kStrobeGroup;
  writer.describe_group(root, "driven motion seen once per period, after its transient");
  writer.write(root + "/key", axis.key, {"", "the scene's key"});
  writer.write(root + "/label", axis.label, {"", "name of the key for an axis"});
  for (const auto& [start, points] : runs) {
    std::vector<double> parameter, contact, order, mismatch, alternating, effective, gap;
    std::vector<double> section_parameter, section_contact, section_displacement;
    std::vector<std::string> failure;
    for (const StrobePoint& point : points) {
      const Eigen::Index contacts = std::max<Eigen::Index>(point.alternating.size(), 1);
      for (Eigen::Index c = 0; c < contacts; ++c) {
        const bool ok = point.failure.empty();
        parameter.push_back(point.parameter);
        contact.push_back(static_cast<double>(c));
        order.push_back(point.order);
        mismatch.push_back(point.mismatch);
        alternating.push_back(ok ? point.alternating(c) : kNone);
        effective.push_back(ok ? point.effective(c) : kNone);
        gap.push_back(ok ? point.sine_gap(c) : kNone);
        failure.push_back(point.failure);
        if (!ok) continue;
        for (const double displacement : point.section.row(c)) {
          section_parameter.push_back(point.parameter);
          section_contact.push_back(static_cast<double>(c));
          section_displacement.push_back(displacement);
        }
      }
    }
    const std::string group = root + "/from_" + start;
    save(writer, group + "/values",
         Table{"one row per value of the key and contact",
               {{"parameter", {axis.units, axis.key}, parameter},
                {"contact", {"", "number of the contact, from 0"}, contact},
                {"order", {"", "periods of the drive after which sections repeat; 0: none"}, order},
                {"mismatch", {"1", "largest difference of such sections, relative"}, mismatch},
                {"alternating", {length_unit, "(max - min)/2 of the contact's displacement"}, alternating},
                {"effective", {length_unit, "root mean square about the mean"}, effective},
                {"sine_gap", {"1", "|sqrt(2) effective - alternating| / alternating"}, gap},
                {"failure", {"", "why the value failed; empty: it did not"}, failure}}});
    save(writer, group + "/sections",
         Table{"one row per value, contact and section",
               {{"parameter", {axis.units, axis.key}, section_parameter},
                {"contact", {"", "number of the contact, from 0"}, section_contact},
                {"displacement", {length_unit, "of the contact"}, section_displacement}}});
  }
}

}  // namespace slipmode::results
