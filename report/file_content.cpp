#include "report/internal/file_content.hpp"
#include "report/internal/animation.hpp"

#include <slipmode/core/to_vector.hpp>
#include <slipmode/figures/file_figures.hpp>
#include <slipmode/results/file_kind.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/result_fields.hpp>
#include <slipmode/results/table.hpp>

#include <algorithm>
#include <numeric>
#include <utility>

namespace slipmode::report {
namespace {

/// Longer tables are left in their file: a page shows none of it, and a figure shows them better.
constexpr std::size_t kMostRows = 2000;

/// Points have no order: by x, then y, their differences are small.
figures::Series sorted(const figures::Series& points) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(points.x.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::sort(order, {}, [&](Eigen::Index i) { return std::pair(points.x[i], points.y[i]); });
  return {points.title, points.x(order), points.y(order), points.look, points.colour};
}

Json series_json(const figures::Series& own, const figures::Drawing::Axes& axes) {
  const bool dots = own.look == figures::Series::Look::kDots;
  const figures::Series drawn = dots ? sorted(own) : own;
  const Grain grain = dots ? Grain::kCoarse : Grain::kFine;
  Json out = {{"title", own.title},
              {"look", word_of(own.look)},
              {"colour", own.colour},
              {"x", list_json(drawn.x, grain, axes.log_x)},
              {"y", list_json(drawn.y, grain, axes.log_y)}};
  if (own.error.size() > 0) out["error"] = list_json(own.error);
  return out;
}

Json field_json(const figures::ColourField& field) {
  return {{"x", list_json(field.x)},
          {"y", list_json(field.y)},
          {"value", list_json(field.value.transpose().reshaped(), Grain::kCoarse)},
          {"label", field.label},
          {"low", number_json(field.low)},
          {"high", number_json(field.high)},
          {"words", field.words},
          {"missing", field.missing}};
}

Json drawing_json(const figures::Drawing& drawing) {
  Json panels = Json::array();
  for (const figures::Drawing::Axes& axes : drawing.panels) {
    Json panel = {{"title", axes.title}, {"x_label", axes.x_label}, {"y_label", axes.y_label},
                  {"log_x", axes.log_x}, {"log_y", axes.log_y},     {"series", Json::array()}};
    for (const figures::Series& series : axes.series) panel["series"].push_back(series_json(series, axes));
    for (const auto& [from, to] : axes.shaded) panel["shaded"].push_back({number_json(from), number_json(to)});
    if (axes.field) panel["field"] = field_json(*axes.field);
    panels.push_back(std::move(panel));
  }
  return {{"columns", drawing.columns},
          {"shared_x", word_of(drawing.x)},
          {"shared_y", word_of(drawing.y)},
          {"panels", std::move(panels)}};
}

Json figures_json(const results::StoreReader& store) {
  Json out = Json::array();
  for (const figures::FileFigure& figure : figures::figures_of(store)) {
    const figures::Drawing drawing = figure.draw(store).drawing();
    if (drawing.panels.empty()) continue;
    out.push_back({{"name", figure.name}, {"what", figure.what}, {"drawing", drawing_json(drawing)}});
  }
  return out;
}

Json tables_json(const results::StoreReader& store) {
  Json out = Json::array();
  for (const results::StoreEntry& entry : store.entries()) {
    const bool group = entry.kind == results::StoreEntry::Kind::kGroup;
    // Names of columns are texts; a sparse matrix has numbers of that name.
    const std::string columns = entry.name + "/columns";
    if (group && store.has(columns) && store.entry(columns).kind == results::StoreEntry::Kind::kText)
      out.push_back(table_json(store, entry.name));
  }
  return out;
}

Json audit_json(const dynamics::EnergyAudit& audit) {
  Json out = {{"residual", number_json(audit.residual())}};
  for_each_field<dynamics::EnergyAudit>([&](const auto& field) { out[field.name] = number_json(audit.*field.member); });
  return out;
}

Json provenance_json(const results::Provenance& own) {
  Json out = {{"command", own.command}, {"scene", own.scene_path},     {"overrides", own.overrides},
              {"version", own.version}, {"commit", own.git_commit},    {"compiler", own.compiler},
              {"seed", own.seed},       {"scene_text", own.scene_text}};
  if (own.audit) out["audit"] = audit_json(*own.audit);
  return out;
}

}  // namespace

Json table_json(const results::StoreReader& store, const std::string& group) {
  const results::Table table = results::load_table(store, group);
  const bool shown = table.rows() <= kMostRows;
  Json columns = Json::array();
  for (const results::Column& column : table.columns) {
    Json values = Json::array();
    if (const auto* numbers = std::get_if<std::vector<double>>(&column.values)) {
      for (std::size_t i = 0; shown && i < numbers->size(); ++i) values.push_back(number_json((*numbers)[i]));
    } else if (shown) {
      values = std::get<std::vector<std::string>>(column.values);
    }
    columns.push_back({{"name", column.name},
                       {"unit", column.meaning.units},
                       {"meaning", column.meaning.description},
                       {"values", std::move(values)}});
  }
  return {{"name", group},
          {"what", store.entry(group).meaning.description},
          {"rows", table.rows()},
          {"left_out", !shown},
          {"columns", std::move(columns)}};
}

Json file_json(const results::StoreReader& store, bool with_figures) {
  const auto kind = results::kind_of(store);
  if (!kind) {
    throw InvalidInput(store.path().string() +
                       ": no result file of slipmode's; expected one that a verb's -o made ('slipmode info' tells)");
  }
  const results::FileKindWords& words = results::words_of(*kind);
  Json out = {{"name", store.path().filename().string()},
              {"kind", words.word},
              {"meaning", words.meaning},
              {"made_by", words.made_by}};
  if (store.has("provenance")) out["provenance"] = provenance_json(results::load_provenance(store));
  out["animation"] = animation_json(store);
  out["tables"] = tables_json(store);
  out["figures"] = with_figures ? figures_json(store) : Json::array();
  return out;
}

}  // namespace slipmode::report
