#include <slipmode/results/basins_store.hpp>

#include <slipmode/core/none.hpp>
#include <slipmode/results/orbit_records.hpp>
#include "results/internal/grid_rows.hpp"
#include "results/internal/journal_line.hpp"

#include <fmt/format.h>
#include <utility>

namespace slipmode::results {
namespace {

using orbits::BasinAttractor;
using orbits::BasinCell;
using orbits::BasinFinder;
using orbits::Basins;

void list_line(detail::Line& line, SweptValue<orbits::BasinLine>& row) {
  auto& [cells, found] = row.settled;
  std::size_t size = cells.size(), many = found.size();
  line(size, many);
  cells.resize(size);
  found.resize(many);
  for (BasinCell& cell : cells) line(cell.attractor, cell.periods, cell.met_event, cell.coordinate);
  for (BasinFinder::Found& one : found) line(one.order, one.state);
  detail::list_failures(line, row.failure, cells);
}

/// Columns that say of attractors what they are and how many starts end there.
struct AttractorColumns {
  std::vector<double> value, number, order, crossings, multiplier, exponent, exponent_error, cells, share, error, met;
  std::vector<std::string> kind;

  void add(double of_value, const std::vector<BasinAttractor>& attractors,
           const std::vector<diagnostics::BasinShare>& shares) {
    for (const diagnostics::BasinShare& own : shares) {
      const bool decided = own.attractor >= 0;
      const BasinAttractor none, &one = decided ? attractors[static_cast<std::size_t>(own.attractor)] : none;
      const bool has_orbit = decided && one.kind != BasinAttractor::Kind::kChaotic;
      value.push_back(of_value);
      number.push_back(own.attractor);
      kind.push_back(decided ? to_string(one.kind) : "undecided");
      order.push_back(has_orbit ? one.orbit.order : 0.0);
      crossings.push_back(has_orbit ? one.orbit.crossings : 0.0);
      multiplier.push_back(has_orbit ? one.orbit.leading_modulus : kNone);
      exponent.push_back(one.exponent);
      exponent_error.push_back(one.exponent_error);
      cells.push_back(static_cast<double>(own.cells));
      share.push_back(own.share);
      error.push_back(own.error);
      met.push_back(own.met_event);
    }
  }

  [[nodiscard]] Table table(const SweepAxis* third, const Units& units) const {
    Table all{.description = "attractors with their shares of the starts, the undecided last", .columns = {}};
    if (third != nullptr) all.columns.push_back({"value", {third->units, third->key}, value});
    const std::vector<Column> rest = {
        {"attractor", {"", "its number; -1: undecided"}, number},
        {"kind", {"", "orbit, gap (between the stops), gap-edge, chaotic or undecided"}, kind},
        {"order", {"", "period in periods of the drive; 0: none"}, order},
        {"crossings", {"", "changes of force law in a period"}, crossings},
        {"multiplier", {"1", "largest |multiplier|, those of a family left out"}, multiplier},
        {"exponent", {units.rate, "largest Lyapunov exponent of a chaotic one"}, exponent},
        {"exponent_error", {units.rate, "its standard error"}, exponent_error},
        {"starts", {"", "that end there"}, cells},
        {"share", {"1", "of all starts"}, share},
        {"share_error", {"1", "standard error, of the grid's resolution"}, error},
        {"met_event", {"1", "share of the own starts that met an event on the way, as a stop"}, met}};
    all.columns.insert(all.columns.end(), rest.begin(), rest.end());
    return all;
  }
};

void store_points(StoreWriter& writer, const std::string& group, const BasinAttractor& attractor) {
  writer.write_columns(group + "/points", attractor.points,
                       {"",
                        "state (displacements, velocities, own states of contacts) once per period of the drive, at "
                        "its phase of time 0; point x coordinate"});
  if (attractor.kind == BasinAttractor::Kind::kOrbit && attractor.trap.radius > 0.0) {
    writer.write(group + "/trap_metric", attractor.trap.L,
                 {"", "L: |L (x - first point)| <= radius leads to the orbit"});
    writer.write(group + "/trap_radius", attractor.trap.radius, {"1", "radius of that neighbourhood"});
  }
  if (attractor.kind != BasinAttractor::Kind::kChaotic) save(writer, group + "/orbit", attractor.orbit);
}

}  // namespace

orbits::BasinSink basin_sink(Journal& journal, const std::string& part) {
  return detail::table_sink<orbits::BasinLine>(journal, part, list_line);
}

std::string attractor_text(const std::string& kind, double order, double crossings) {
  return kind == "orbit" ? fmt::format("period {:g}, {:g} crossings", order, crossings) : kind;
}

std::string attractor_text(const std::vector<BasinAttractor>& attractors, int attractor) {
  if (attractor < 0) return "undecided";
  const BasinAttractor& one = attractors[static_cast<std::size_t>(attractor)];
  return attractor_text(to_string(one.kind), one.orbit.order, one.orbit.crossings);
}

void store_basins(StoreWriter& writer, const SweepAxis& x, const SweepAxis& y, const orbits::MapGrid& grid,
                  const Basins& basins, const diagnostics::BasinMeasures& measures, const SweepAxis& third,
                  const std::vector<BasinsAlong>& along, const Units& units) {
  const std::string root = kBasinsGroup;
  writer.describe_group(root, "which attractor each start ends on; datasets are y x x");
  store_axis(writer, root + "/x", x, grid.x);
  store_axis(writer, root + "/y", y, grid.y);
  const auto write = [&](const std::string& name, const Meaning& meaning, auto number) {
    writer.write(root + "/" + name, detail::layer(basins.rows, grid.x.size(), number), meaning);
  };
  write("attractor", {"", "number of the attractor; -1: undecided"}, [](const BasinCell& c) { return c.attractor; });
  write("periods", {"", "of the drive until that was known"}, [](const BasinCell& c) { return c.periods; });
  write("met_event", {"", "1: met an event on the way, as a stop"}, [](const BasinCell& c) { return c.met_event; });
  write(
      "coordinate",
      {units.length, "in the gap: mean displacement of the first clearance, or amplitude of free vibration; else NaN"},
      [](const BasinCell& c) { return c.coordinate; });
  if (basins.room.size() > 0) {
    writer.write(root + "/room", basins.room,
                 {units.length,
                  "distance to the stops of the steady motion that the start would end in were there no "
                  "stops; positive: it fits in the gap"});
  }
  detail::store_failures(writer, root + "/failures", grid, basins.rows);
  AttractorColumns attractors;
  attractors.add(kNone, basins.attractors, measures.shares);
  save(writer, root + "/attractors", attractors.table(nullptr, units));
  for (std::size_t k = 0; k < basins.attractors.size(); ++k) {
    store_points(writer, fmt::format("{}/attractor_{:03}", root, k), basins.attractors[k]);
  }
  const diagnostics::BoundaryUncertainty& boundary = measures.boundary;
  save(writer, root + "/uncertainty",
       Table{"starts from which a step along either key leads to another attractor",
             {{"displacement", {"", "the step, in cells of the grid"}, boundary.displacement},
              {"share", {"1", "of such starts"}, boundary.share}}});
  writer.write(root + "/uncertainty_exponent", boundary.exponent,
               {"1", "alpha in share ~ step^alpha; the boundary's dimension is 2 - alpha"});
  writer.write(root + "/uncertainty_error", boundary.error, {"1", "standard error of alpha, of the fit"});
  if (along.empty()) return;
  AttractorColumns columns;
  for (const BasinsAlong& one : along) columns.add(one.value, one.attractors, one.shares);
  writer.write(root + "/along_label", third.label, {"", "name of the third key for an axis"});
  save(writer, root + "/along", columns.table(&third, units));
}

}  // namespace slipmode::results
