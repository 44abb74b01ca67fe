#include <slipmode/core/errors.hpp>
#include <slipmode/core/numbers.hpp>
#include "scene/internal/toml_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cctype>
#include <numeric>
#include <sstream>
#include <utility>

namespace slipmode::scene {

namespace {

bool is_bare_word(const std::string& text) {
  return !text.empty() &&
         std::ranges::all_of(text, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; }) &&
         std::isalpha(static_cast<unsigned char>(text.front())) != 0;
}

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

[[noreturn]] void fail_override(const std::string& file, const std::string& text, const std::string& what) {
  throw InvalidInput(fmt::format("{}: override {}: {}", file, text, what));
}

/// The value of an override: TOML, or a bare word taken as a string so that a shell needs no inner quotes.
toml::table parse_value(const std::string& value) {
  const bool keyword = value == "true" || value == "false" || value == "nan" || value == "inf";
  if (is_bare_word(value) && !keyword) {
    toml::table table;
    table.insert("value", value);
    return table;
  }
  return toml::parse("value = " + value);
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Letters to insert, drop, replace or swap with their neighbour to turn `a` into `b` (optimal string alignment).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({last[j] + (a[i] == b[j] ? 0 : 1), last[j + 1] + 1, row[j] + 1});
      const bool swapped = i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j];
      if (swapped) row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
    before = std::exchange(last, row);
  }
  return last.back();
}

std::string full_text(const toml::node& node) {
  if (const auto* text = node.as_string()) return fmt::format("\"{}\"", text->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* array = node.as_array()) {
    std::vector<std::string> items;
    for (const toml::node& item : *array) items.push_back(full_text(item));
    return fmt::format("[{}]", fmt::join(items, ", "));
  }
  if (node.is_table()) return "a table";
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  return out.str();
}

}  // namespace

TomlDocument::TomlDocument(const std::string& text, const std::string& path, const std::vector<std::string>& overrides)
    : path_(path) {
  try {
    root_ = toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw InvalidInput(fmt::format("{}:{}: not valid TOML: {}", path, error.source().begin.line, error.description()));
  }
  for (const auto& [key, node] : root_) written_.emplace(key.str());
  for (const std::string& override_text : overrides) apply(override_text);
}

void TomlDocument::apply(const std::string& override_text) {
  const std::size_t equals = override_text.find('=');
  if (equals == std::string::npos || equals == 0) {
    fail_override(path_, override_text, "expected PATH=VALUE, for example drive.speed=0.25");
  }
  std::string key_path = override_text.substr(0, equals);
  while (!key_path.empty() && key_path.back() == ' ') key_path.pop_back();
  std::string value_part = override_text.substr(equals + 1);
  while (!value_part.empty() && value_part.front() == ' ') value_part.erase(0, 1);
  const std::vector<std::string> parts = split(key_path);
  if (std::ranges::any_of(parts, &std::string::empty)) {
    fail_override(path_, override_text, "the path has an empty part; expected for example drive.speed");
  }

  toml::table parsed;
  try {
    parsed = parse_value(value_part);
  } catch (const toml::parse_error& error) {
    fail_override(path_, override_text, fmt::format("the value is not TOML: {}", error.description()));
  }
  if (parsed.size() != 1) fail_override(path_, override_text, "expected one value");
  const toml::node& value = *parsed.get("value");

  toml::node* here = &root_;
  std::string so_far;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string& part = parts[i];
    const bool last = i + 1 == parts.size();
    const std::string parent = so_far.empty() ? "the scene" : so_far;
    so_far += (so_far.empty() ? "" : ".") + part;
    if (toml::array* array = here->as_array()) {
      const auto index = number_in<std::size_t>(part);
      if (!index || *index >= array->size()) {
        fail_override(path_, override_text,
                      fmt::format("{} has {} entries; valid: 0 to {}", parent, array->size(),
                                  static_cast<std::int64_t>(array->size()) - 1));
      }
      if (last) array->replace(array->begin() + static_cast<std::ptrdiff_t>(*index), value);
      here = array->get(*index);
    } else if (toml::table* table = here->as_table()) {
      if (last) {
        table->insert_or_assign(part, value);
      } else if (table->get(part) == nullptr) {
        table->insert(part, toml::table{});
        overridden_[so_far] = override_text;
      }
      here = table->get(part);
    } else {
      fail_override(path_, override_text,
                    fmt::format("{} = {} has no keys; valid: {}=VALUE", parent, value_text(*here), parent));
    }
  }
  overridden_[so_far] = override_text;
}

std::string TomlDocument::place(const std::string& dotted, const toml::node* node) const {
  for (std::string at = dotted;;) {
    const auto found = overridden_.find(at);
    if (found != overridden_.end()) return fmt::format("{}: override {}", path_, found->second);
    const std::size_t dot = at.rfind('.');
    if (dot == std::string::npos) break;
    at.resize(dot);
  }
  const auto line = node != nullptr ? node->source().begin.line : 0;
  return line > 0 ? fmt::format("{}:{}", path_, line) : path_;
}

std::string value_text(const toml::node& node) {
  constexpr std::size_t kLongest = 60;
  std::string text = full_text(node);
  std::ranges::replace(text, '\n', ' ');
  if (text.size() > kLongest) text = text.substr(0, kLongest - 3) + "...";
  return text;
}

std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& candidates) {
  std::optional<std::string> best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(lower(word), lower(candidate));
    if (distance < least && distance < candidate.size()) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace slipmode::scene
