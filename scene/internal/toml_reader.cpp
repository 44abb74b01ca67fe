#include "scene/internal/toml_reader.hpp"

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>

namespace slipmode::scene {

const toml::node* TomlReader::find(const std::string& key) {
  known_.insert(key);
  return table_ != nullptr ? table_->get(key) : nullptr;
}

bool TomlReader::has(const std::string& key) { return find(key) != nullptr; }

bool TomlReader::is_table(const std::string& key) {
  const toml::node* node = find(key);
  return node != nullptr && node->is_table();
}

bool TomlReader::is_text(const std::string& key) {
  const toml::node* node = find(key);
  return node != nullptr && node->is_string();
}

bool TomlReader::is_array(const std::string& key) {
  const toml::node* node = find(key);
  return node != nullptr && node->is_array();
}

const toml::node& TomlReader::need(const std::string& key) {
  if (const toml::node* node = find(key)) return *node;
  std::vector<std::string> strangers;
  if (table_ != nullptr) {
    for (const auto& [name, node] : *table_) {
      if (!known_.contains(std::string(name.str()))) strangers.emplace_back(name.str());
    }
  }
  const auto misspelt = nearest(key, strangers);
  const std::string hint = misspelt ? fmt::format("; is '{}' meant to be '{}'?", *misspelt, key) : "";
  throw InvalidInput(fmt::format("{}: {}: missing key{}; add it", document_->place(path_, table_), dotted(key), hint));
}

void TomlReader::fail(const std::string& key, const std::string& what, const std::string& valid) {
  const toml::node* node = find(key);
  const std::string value = node != nullptr ? " = " + value_text(*node) : "";
  throw InvalidInput(fmt::format("{}: {}{}: {}; valid: {}",
                                 document_->place(dotted(key), node != nullptr ? node : table_), dotted(key), value,
                                 what, valid));
}

void TomlReader::refuse(const std::string& key, const std::string& why, const std::string& valid) {
  if (table_ != nullptr && table_->contains(key)) fail(key, why, valid);
}

void TomlReader::finish() {
  if (table_ == nullptr) return;
  for (const auto& [name, node] : *table_) {
    const std::string key(name.str());
    if (known_.contains(key)) continue;
    const std::vector<std::string> valid(known_.begin(), known_.end());
    const auto meant = nearest(key, valid);
    throw InvalidInput(fmt::format("{}: {} = {}: unknown key{}; valid: {}", document_->place(dotted(key), &node),
                                   dotted(key), value_text(node),
                                   meant ? fmt::format(", did you mean '{}'?", *meant) : "", fmt::join(valid, ", ")));
  }
}

double TomlReader::checked_number(const std::string& key, const toml::node& node, const Limits& limits) {
  if (!node.is_number()) fail(key, "wrong type", limits.text);
  const double value =
      node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
  if (!std::isfinite(value)) fail(key, "not a finite number", limits.text);
  const bool too_low = limits.above ? value <= limits.low : value < limits.low;
  if (too_low || value > limits.high) fail(key, "impossible value", limits.text);
  return value;
}

std::int64_t TomlReader::checked_integer(const std::string& key, const toml::node& node, const Limits& limits,
                                         std::int64_t most) {
  if (!node.is_integer()) fail(key, "wrong type", integer_text(limits));
  const std::int64_t value = node.as_integer()->get();
  if (!limits.hold(static_cast<double>(value)) || value > most) {
    fail(key, "impossible value", integer_text(limits));
  }
  return value;
}

double TomlReader::number(const std::string& key, const Limits& limits) {
  return checked_number(key, need(key), limits);
}

double TomlReader::number_or(const std::string& key, double otherwise, const Limits& limits) {
  const toml::node* node = find(key);
  return node != nullptr ? checked_number(key, *node, limits) : otherwise;
}

std::string TomlReader::text_or(const std::string& key, const std::string& otherwise) {
  const toml::node* node = find(key);
  if (node == nullptr) return otherwise;
  if (!node->is_string()) fail(key, "wrong type", "a string in quotes");
  return node->as_string()->get();
}

bool TomlReader::flag_or(const std::string& key, bool otherwise) {
  const toml::node* node = find(key);
  if (node == nullptr) return otherwise;
  if (!node->is_boolean()) fail(key, "wrong type", "true or false");
  return node->as_boolean()->get();
}

std::vector<std::string> TomlReader::texts(const std::string& key) {
  const toml::node& node = need(key);
  std::vector<std::string> found;
  if (!node.is_array()) fail(key, "wrong type", "an array of strings");
  for (const toml::node& item : *node.as_array()) {
    if (!item.is_string()) fail(key, "wrong type", "an array of strings");
    found.push_back(item.as_string()->get());
  }
  return found;
}

std::size_t TomlReader::checked_word(const std::string& key, const toml::node& node,
                                     const std::vector<std::string>& words) {
  const std::string valid = fmt::format("\"{}\"", fmt::join(words, "\", \""));
  if (!node.is_string()) fail(key, "wrong type", valid);
  const std::string& word = node.as_string()->get();
  const auto found = std::ranges::find(words, word);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  const auto meant = nearest(word, words);
  fail(key, meant ? fmt::format("unknown word, did you mean \"{}\"?", *meant) : "unknown word", valid);
}

std::size_t TomlReader::choice(const std::string& key, const std::vector<std::string>& words) {
  return checked_word(key, need(key), words);
}

std::vector<std::size_t> TomlReader::choices(const std::string& key, const std::vector<std::string>& words) {
  const toml::node& node = need(key);
  const std::string valid = fmt::format("an array of one or more of \"{}\", none twice", fmt::join(words, "\", \""));
  if (!node.is_array()) fail(key, "wrong type", valid);
  if (node.as_array()->empty()) fail(key, "empty", valid);
  std::vector<std::size_t> found;
  for (const toml::node& item : *node.as_array()) {
    const std::size_t index = checked_word(key, item, words);
    if (std::ranges::find(found, index) != found.end()) fail(key, fmt::format("\"{}\" twice", words[index]), valid);
    found.push_back(index);
  }
  return found;
}

std::size_t TomlReader::choice_or(const std::string& key, std::size_t otherwise,
                                  const std::vector<std::string>& words) {
  return has(key) ? choice(key, words) : otherwise;
}

std::vector<double> TomlReader::per_item(const std::string& key, const Limits& limits, std::int64_t count) {
  if (!is_array(key)) return {number(key, limits)};
  return numbers(key, limits, count);
}

std::vector<double> TomlReader::numbers(const std::string& key, const Limits& limits, std::int64_t count) {
  const toml::node& node = need(key);
  const std::string valid = count < 0 ? fmt::format("an array, each {}", limits.text)
                                      : fmt::format("an array of {} values, each {}", count, limits.text);
  if (!node.is_array()) fail(key, "wrong type", valid);
  const toml::array& array = *node.as_array();
  if (count >= 0 && static_cast<std::int64_t>(array.size()) != count) {
    fail(key, fmt::format("{} values", array.size()), valid);
  }
  std::vector<double> values;
  for (const toml::node& item : array) values.push_back(checked_number(key, item, limits));
  return values;
}

std::vector<int> TomlReader::integers(const std::string& key, const Limits& limits) {
  const toml::node& node = need(key);
  if (!node.is_array()) fail(key, "wrong type", "an array, each " + integer_text(limits));
  std::vector<int> values;
  for (const toml::node& item : *node.as_array()) {
    values.push_back(static_cast<int>(checked_integer(key, item, limits, std::numeric_limits<int>::max())));
  }
  return values;
}

std::vector<std::pair<double, double>> TomlReader::pairs(const std::string& key, const Limits& first,
                                                         const Limits& second) {
  const toml::node& node = need(key);
  const std::string valid = fmt::format("[[{}, {}], ...]", first.text, second.text);
  if (!node.is_array()) fail(key, "wrong type", valid);
  std::vector<std::pair<double, double>> values;
  for (const toml::node& item : *node.as_array()) {
    const toml::array* pair = item.as_array();
    if (pair == nullptr || pair->size() != 2) fail(key, fmt::format("{} is no pair", value_text(item)), valid);
    values.emplace_back(checked_number(key, *pair->get(0), first), checked_number(key, *pair->get(1), second));
  }
  return values;
}

Eigen::MatrixXd TomlReader::square(const std::string& key, Eigen::Index n) {
  const toml::node& node = need(key);
  const std::string valid = n < 0 ? std::string("a square matrix, an array of rows [[...], ...]")
                                  : fmt::format("a {} x {} matrix, an array of rows [[...], ...]", n, n);
  if (!node.is_array() || node.as_array()->empty()) fail(key, "wrong type", valid);
  const toml::array& rows = *node.as_array();
  const auto size = static_cast<Eigen::Index>(rows.size());
  if (n >= 0 && size != n) fail(key, fmt::format("{} rows", size), valid);
  Eigen::MatrixXd matrix(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const toml::array* row = rows.get(static_cast<std::size_t>(i))->as_array();
    if (row == nullptr || row->size() != rows.size()) {
      fail(key, fmt::format("row {} is no array of {} numbers", i + 1, size), valid);
    }
    for (Eigen::Index j = 0; j < size; ++j) {
      matrix(i, j) = checked_number(key, *row->get(static_cast<std::size_t>(j)), kFinite);
    }
  }
  return matrix;
}

TomlReader TomlReader::table(const std::string& key) {
  const toml::node& node = need(key);
  if (!node.is_table()) fail(key, "wrong type", fmt::format("a table, [{}]", dotted(key)));
  return {*document_, node.as_table(), dotted(key)};
}

TomlReader TomlReader::table_or_empty(const std::string& key) {
  if (!has(key)) return {*document_, nullptr, dotted(key)};
  return table(key);
}

std::vector<TomlReader> TomlReader::tables(const std::string& key) {
  const toml::node& node = need(key);
  const std::string valid = fmt::format("one or more tables, [[{}]]", dotted(key));
  if (!node.is_array_of_tables()) fail(key, "wrong type", valid);
  std::vector<TomlReader> readers;
  for (const toml::node& item : *node.as_array()) {
    readers.push_back(TomlReader(*document_, item.as_table(), fmt::format("{}.{}", dotted(key), readers.size())));
  }
  return readers;
}

}  // namespace slipmode::scene
