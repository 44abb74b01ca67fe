#include <slipmode/results/map_store.hpp>

#include <slipmode/core/none.hpp>
#include "results/internal/grid_rows.hpp"
#include "results/internal/journal_line.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::results {
namespace {

using orbits::MapPoint;
using orbits::StrobePoint;

void list_point(detail::Line& line, MapPoint& point) {
  line(point.order, point.crossings, point.multiplier, point.symmetric, point.floating, point.alternating,
       point.residual, point.periods);
}

void list_row(detail::Line& line, orbits::MapRow& row) {
  std::size_t size = row.settled.size();
  line(size);
  row.settled.resize(size);
  for (MapPoint& point : row.settled) list_point(line, point);
  detail::list_failures(line, row.failure, row.settled);
}

void list_strobe(detail::Line& line, StrobePoint& point) {
  orbits::Strobe& own = point.settled;
  line(own.order, own.mismatch, own.section, own.alternating, own.effective, own.end);
}

}  // namespace

orbits::MapSink map_sink(Journal& journal, const std::string& start) {
  return detail::table_sink<std::vector<MapPoint>>(journal, start, list_row);
}

orbits::StrobeSink strobe_sink(Journal& journal, const std::string& start) {
  return detail::table_sink<orbits::Strobe>(journal, start, list_strobe);
}

void store_map(StoreWriter& writer, const SweepAxis& x, const SweepAxis& y, const orbits::MapGrid& grid,
               const std::vector<StartedMap>& maps, const std::string& length_unit) {
  const std::string root = kMapGroup;
  writer.describe_group(root, "settled periodic orbits over two keys; datasets are y x x");
  store_axis(writer, root + "/x", x, grid.x);
  store_axis(writer, root + "/y", y, grid.y);
  for (const StartedMap& started : maps) {
    const std::string group = fmt::format("{}/from_{}", root, started.start);
    writer.describe_group(group, started.start == "centre" ? "from the steady linear motion in the middle of the gap"
                                                           : "from the scene's initial state");
    const auto write = [&](const std::string& name, const Meaning& meaning, auto number) {
      writer.write(group + "/" + name, detail::layer(started.map.rows, grid.x.size(), number), meaning);
    };
    write("order", {"", "period in periods of the drive; 0: none found"}, [](const MapPoint& p) { return p.order; });
    write("crossings", {"", "changes of force law in a period; 0 also where none is found"},
          [](const MapPoint& p) { return p.crossings; });
    write("multiplier", {"1", "largest |multiplier|; NaN: not periodic"},
          [](const MapPoint& p) { return p.multiplier; });
    write("symmetric", {"", "1: x(T/2) = -x(0)"}, [](const MapPoint& p) { return p.symmetric ? 1.0 : 0.0; });
    write("floating", {"", "1: one of a family of orbits"}, [](const MapPoint& p) { return p.floating ? 1.0 : 0.0; });
    write("alternating", {length_unit, "(max - min)/2 of the first contact's displacement; NaN: not periodic"},
          [](const MapPoint& p) { return p.alternating; });
    write("residual", {"1", "mismatch of the orbit after its period"}, [](const MapPoint& p) { return p.residual; });
    write("periods", {"", "periods of the drive simulated"}, [](const MapPoint& p) { return p.periods; });
    detail::store_failures(writer, group + "/failures", grid, started.map.rows);
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
      const orbits::Strobe& strobe = point.settled;
      const Eigen::Index contacts = std::max<Eigen::Index>(strobe.alternating.size(), 1);
      for (Eigen::Index c = 0; c < contacts; ++c) {
        const bool ok = point.failure.empty();
        parameter.push_back(point.parameter);
        contact.push_back(static_cast<double>(c));
        order.push_back(strobe.order);
        mismatch.push_back(strobe.mismatch);
        alternating.push_back(ok ? strobe.alternating(c) : kNone);
        effective.push_back(ok ? strobe.effective(c) : kNone);
        gap.push_back(ok ? strobe.sine_gap(c) : kNone);
        failure.push_back(point.failure);
        if (!ok) continue;
        for (const double displacement : strobe.section.row(c)) {
          section_parameter.push_back(point.parameter);
          section_contact.push_back(static_cast<double>(c));
          section_displacement.push_back(displacement);
        }
      }
    }
    const std::string group = fmt::format("{}/from_{}", root, start);
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
