#include <slipmode/results/table.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <set>

namespace slipmode::results {

namespace {

std::size_t length(const Column& column) {
  return std::visit([](const auto& values) { return values.size(); }, column.values);
}

const Column& find(const Table& table, const std::string& name) {
  const auto found = std::ranges::find(table.columns, name, &Column::name);
  if (found != table.columns.end()) return *found;
  std::vector<std::string> names;
  for (const Column& column : table.columns) names.push_back(column.name);
  throw InvalidInput(fmt::format("column {} is missing from the table; it has: {}", name, fmt::join(names, ", ")));
}

void check(const std::string& group, const Table& table) {
  std::set<std::string> names;
  for (const Column& column : table.columns) {
    if (column.name.empty() || column.name == "columns" || column.name.find('/') != std::string::npos ||
        !names.insert(column.name).second) {
      throw InvalidInput(fmt::format("{}: column name '{}' is empty, used twice, reserved or has a slash; rename it",
                                     group, column.name));
    }
    if (length(column) != table.rows()) {
      throw InvalidInput(fmt::format("{}: column {} has {} rows, the first one has {}; all must be of one length",
                                     group, column.name, length(column), table.rows()));
    }
  }
}

}  // namespace

std::size_t Table::rows() const { return columns.empty() ? 0 : length(columns.front()); }

const std::vector<double>& Table::numbers(const std::string& name) const {
  const auto* values = std::get_if<std::vector<double>>(&find(*this, name).values);
  if (values == nullptr) throw InvalidInput(fmt::format("column {} holds texts; expected numbers", name));
  return *values;
}

const std::vector<std::string>& Table::texts(const std::string& name) const {
  const auto* values = std::get_if<std::vector<std::string>>(&find(*this, name).values);
  if (values == nullptr) throw InvalidInput(fmt::format("column {} holds numbers; expected texts", name));
  return *values;
}

bool Table::has(const std::string& name) const {
  return std::ranges::find(columns, name, &Column::name) != columns.end();
}

void save(StoreWriter& store, const std::string& group, const Table& table) {
  check(group, table);
  store.describe_group(group, table.description);
  std::vector<std::string> names;
  for (const Column& column : table.columns) {
    names.push_back(column.name);
    std::visit([&](const auto& values) { store.write(group + "/" + column.name, values, column.meaning); },
               column.values);
  }
  store.write(group + "/columns", names, {"", "the table's columns in order, one dataset each"});
}

Table load_table(const StoreReader& store, const std::string& group) {
  Table table;
  const std::vector<std::string> names = store.texts(group + "/columns");
  table.description = store.entry(group).meaning.description;
  Eigen::Index rows = StoreReader::kAny;
  for (const std::string& name : names) {
    const std::string path = group + "/" + name;
    const StoreEntry entry = store.entry(path);
    Column column{name, entry.meaning, {}};
    if (entry.kind == StoreEntry::Kind::kText) {
      column.values = store.texts(path, rows);
    } else {
      const Eigen::VectorXd values = store.vector(path, rows);
      column.values = std::vector<double>(values.begin(), values.end());
    }
    rows = static_cast<Eigen::Index>(length(column));
    table.columns.push_back(std::move(column));
  }
  return table;
}

}  // namespace slipmode::results
