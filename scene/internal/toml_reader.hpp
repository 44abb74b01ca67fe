#pragma once

// The only header that shows toml++.

#include <slipmode/core/fields.hpp>

#include <toml++/toml.h>
#include <Eigen/Core>
#include <concepts>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace slipmode::scene {

/// A TOML text with overrides applied. It remembers which values came from an override, so that a message can say where
/// a value stands: "file:line" or "file: override drive.speed=-1".
class TomlDocument {
 public:
  /// @param overrides  "path=value"; tables on the way are made when missing, array entries must exist
  /// @throws InvalidInput  for bad TOML (file and line) or an override that cannot be read or applied
  TomlDocument(const std::string& text, const std::string& path, const std::vector<std::string>& overrides);

  [[nodiscard]] const toml::table& root() const { return root_; }
  /// Keys at the top of the text, before overrides.
  [[nodiscard]] const std::set<std::string>& written() const { return written_; }
  /// Place of a value.
  /// @param dotted  its path, "contact.0.mu_s"
  /// @param node    the value, or the table in which it is missing
  [[nodiscard]] std::string place(const std::string& dotted, const toml::node* node) const;

 private:
  void apply(const std::string& override_text);

  toml::table root_;
  std::set<std::string> written_;
  std::string path_;
  std::map<std::string, std::string> overridden_;  // dotted path -> text of the override
};

/// A value as it would stand in the file, shortened when long.
[[nodiscard]] std::string value_text(const toml::node& node);

/// The candidate nearest to `word` by edit distance, if near enough to be a misspelling.
[[nodiscard]] std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& candidates);

/// Reads one table key by key. Each key asked for becomes a known one; `finish` rejects all others. So a scene's schema
/// is the code that reads it, and a new key is one line.
///
/// Every reader throws InvalidInput "place: key = value: what is wrong; valid: ...". A reader of an absent optional
/// table is empty: all keys take their defaults.
class TomlReader {
 public:
  explicit TomlReader(const TomlDocument& document) : TomlReader(document, &document.root(), "") {}

  [[nodiscard]] bool has(const std::string& key);

  /// Reports a key that is not there.
  void require(const std::string& key) { static_cast<void>(need(key)); }

  [[nodiscard]] double number(const std::string& key, const Limits& limits);
  [[nodiscard]] double number_or(const std::string& key, double otherwise, const Limits& limits);
  template <std::integral T>
  [[nodiscard]] T integer(const std::string& key, const Limits& limits) {
    constexpr auto kMost = std::in_range<std::int64_t>(std::numeric_limits<T>::max())
                               ? static_cast<std::int64_t>(std::numeric_limits<T>::max())
                               : std::numeric_limits<std::int64_t>::max();
    return static_cast<T>(checked_integer(key, need(key), limits, kMost));
  }
  [[nodiscard]] std::string text_or(const std::string& key, const std::string& otherwise);
  [[nodiscard]] bool flag_or(const std::string& key, bool otherwise);
  /// An array of strings.
  [[nodiscard]] std::vector<std::string> texts(const std::string& key);
  /// Index of the word among `words`.
  [[nodiscard]] std::size_t choice(const std::string& key, const std::vector<std::string>& words);
  [[nodiscard]] std::size_t choice_or(const std::string& key, std::size_t otherwise,
                                      const std::vector<std::string>& words);
  /// A number (then one value) or an array of numbers, of any length, or of `count` when that is not negative.
  [[nodiscard]] std::vector<double> per_item(const std::string& key, const Limits& limits, std::int64_t count = -1);
  [[nodiscard]] std::vector<double> numbers(const std::string& key, const Limits& limits, std::int64_t count = -1);
  [[nodiscard]] std::vector<int> integers(const std::string& key, const Limits& limits);
  /// An array of pairs of numbers, [[first, second], ...].
  [[nodiscard]] std::vector<std::pair<double, double>> pairs(const std::string& key, const Limits& first,
                                                             const Limits& second);
  /// A square matrix as an array of rows, n x n; of any size when n is negative.
  [[nodiscard]] Eigen::MatrixXd square(const std::string& key, Eigen::Index n = -1);
  /// Indices of the words of an array among `words`, at least one, none twice.
  [[nodiscard]] std::vector<std::size_t> choices(const std::string& key, const std::vector<std::string>& words);

  /// True when the key is there and holds a table (a string, an array).
  [[nodiscard]] bool is_table(const std::string& key);
  [[nodiscard]] bool is_text(const std::string& key);
  [[nodiscard]] bool is_array(const std::string& key);
  [[nodiscard]] TomlReader table(const std::string& key);
  [[nodiscard]] TomlReader table_or_empty(const std::string& key);
  /// The entries of [[key]], at least one.
  [[nodiscard]] std::vector<TomlReader> tables(const std::string& key);

  /// Reports the value of `key` as wrong.
  [[noreturn]] void fail(const std::string& key, const std::string& what, const std::string& valid);
  /// Reports a key that is known elsewhere but has no place here, if it is there.
  void refuse(const std::string& key, const std::string& why, const std::string& valid);
  /// Reports the first key that nobody asked for.
  void finish();

 private:
  TomlReader(const TomlDocument& document, const toml::table* table, std::string path)
      : document_(&document), table_(table), path_(std::move(path)) {}

  [[nodiscard]] std::string dotted(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  [[nodiscard]] const toml::node* find(const std::string& key);
  [[nodiscard]] const toml::node& need(const std::string& key);
  [[nodiscard]] double checked_number(const std::string& key, const toml::node& node, const Limits& limits);
  [[nodiscard]] std::size_t checked_word(const std::string& key, const toml::node& node,
                                         const std::vector<std::string>& words);
  [[nodiscard]] std::int64_t checked_integer(const std::string& key, const toml::node& node, const Limits& limits,
                                             std::int64_t most);

  const TomlDocument* document_;
  const toml::table* table_;
  std::string path_;
  std::set<std::string> known_;
};

}  // namespace slipmode::scene
