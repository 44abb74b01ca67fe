#include <slipmode/results/info.hpp>

#include <slipmode/results/memory_store.hpp>
#include <slipmode/results/store.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>

namespace slipmode::results {

namespace {

using Kind = StoreEntry::Kind;

constexpr std::int64_t kShownValues = 6;
constexpr std::size_t kShownText = 60;

const char* kind_name(Kind kind) {
  switch (kind) {
    case Kind::kGroup:
      return "group";
    case Kind::kDouble:
      return "float64";
    case Kind::kInteger:
      return "int64";
    case Kind::kText:
      return "text";
    case Kind::kOther:
      break;
  }
  return "other";
}

bool is_short_list(const StoreEntry& entry) {
  return entry.shape.empty() || (entry.shape.size() == 1 && entry.shape[0] > 0 && entry.shape[0] <= kShownValues);
}

nlohmann::json number_json(double value) {
  if (std::isfinite(value)) return value;
  return fmt::format("{}", value);  // JSON has no NaN
}

/// The value of a scalar or short list; null for anything longer.
nlohmann::json value_json(const StoreReader& store, const StoreEntry& entry) {
  if (!is_short_list(entry)) return nullptr;
  const bool scalar = entry.shape.empty();
  if (entry.kind == Kind::kDouble && scalar) return number_json(store.number(entry.name));
  if (entry.kind == Kind::kInteger && scalar) return store.integer(entry.name);
  if (entry.kind == Kind::kText && scalar) return store.text(entry.name);
  if (entry.kind == Kind::kInteger) return store.integers(entry.name);
  if (entry.kind == Kind::kText) return store.texts(entry.name);
  if (entry.kind != Kind::kDouble) return nullptr;
  nlohmann::json list = nlohmann::json::array();
  for (const double value : store.vector(entry.name)) list.push_back(number_json(value));
  return list;
}

std::string value_line(const nlohmann::json& value) {
  std::string text = value.is_string() ? value.get<std::string>()
                                       : value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  const std::size_t lines = static_cast<std::size_t>(std::ranges::count(text, '\n'));
  if (lines > 1) return fmt::format("({} lines)", lines);
  if (text.size() > kShownText) text = text.substr(0, kShownText - 3) + "...";
  return text;
}

std::string entry_line(const StoreReader& store, const StoreEntry& entry) {
  const auto depth = static_cast<std::size_t>(std::ranges::count(entry.name, '/'));
  const std::string leaf = entry.name.substr(entry.name.rfind('/') + 1);
  std::string line = std::string(2 * depth, ' ') + leaf;
  if (entry.kind == Kind::kGroup) {
    line += "/";
  } else {
    line = fmt::format("{:<28} {:<8}", line, kind_name(entry.kind));
    line += fmt::format(" {:<12}", fmt::format("{}", fmt::join(entry.shape, " x ")));
    line += fmt::format(" {:<7}", entry.meaning.units.empty() ? "" : "[" + entry.meaning.units + "]");
    const nlohmann::json value = value_json(store, entry);
    if (!value.is_null()) line += " = " + value_line(value);
  }
  if (!entry.meaning.description.empty()) line += "  # " + entry.meaning.description;
  return line + "\n";
}

nlohmann::json entry_json(const StoreReader& store, const StoreEntry& entry) {
  nlohmann::json out = {{"name", entry.name}, {"kind", kind_name(entry.kind)}};
  if (!entry.meaning.description.empty()) out["description"] = entry.meaning.description;
  if (entry.kind == Kind::kGroup) return out;
  out["shape"] = entry.shape;
  out["units"] = entry.meaning.units;
  const nlohmann::json value = value_json(store, entry);
  if (!value.is_null()) out["value"] = value;
  return out;
}

/// An array as lists of rows. @param next  gives its values, one after another
template <class Next>
nlohmann::json rows_json(std::span<const std::int64_t> shape, const Next& next) {
  if (shape.empty()) return next();
  nlohmann::json rows = nlohmann::json::array();
  for (std::int64_t k = 0; k < shape.front(); ++k) rows.push_back(rows_json(shape.subspan(1), next));
  return rows;
}

nlohmann::json values_json(const Dataset& data) {
  std::size_t at = 0;
  return rows_json(data.shape, [&]() -> nlohmann::json {
    const std::size_t k = at++;
    if (data.integers) return data.integers.get()[k];
    if (!data.numbers) return data.texts[k];
    const double value = data.numbers.get()[k];
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
  });
}

nlohmann::json values_json(const StoreReader& store) {
  nlohmann::json out = nlohmann::json::object();
  for (const StoreEntry& entry : store.entries()) {
    if (entry.kind == Kind::kGroup || entry.kind == Kind::kOther) continue;
    nlohmann::json* place = &out;
    std::istringstream parts(entry.name);
    for (std::string part; std::getline(parts, part, '/');) place = &(*place)[part];
    *place = values_json(store.dataset(entry.name));
  }
  return out;
}

}  // namespace

std::string info(const std::filesystem::path& path, InfoFormat format) {
  const StoreReader store(path);
  const std::optional<FileKind> kind = kind_of(store);
  if (format == InfoFormat::kText) {
    std::string text = path.string();
    if (kind) text += fmt::format(": {}  # {}", words_of(*kind).word, words_of(*kind).meaning);
    text += '\n';
    for (const StoreEntry& entry : store.entries()) text += entry_line(store, entry);
    return text;
  }
  if (format == InfoFormat::kValues)
    return values_json(store).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  nlohmann::json out = {{"file", path.string()}, {"kind", nullptr}, {"contents", nlohmann::json::array()}};
  if (kind) out["kind"] = words_of(*kind).word;
  for (const StoreEntry& entry : store.entries()) out["contents"].push_back(entry_json(store, entry));
  return out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);  // foreign files hold any bytes
}

}  // namespace slipmode::results
