#pragma once

// Values and tables as TOML text.

#include <slipmode/scene/scene.hpp>

#include <string>
#include <vector>

namespace slipmode::scene {

/// Shortest text that reads back to the same double, always seen by TOML as a float.
[[nodiscard]] std::string number_text(double value);
/// `key = value` as a line.
[[nodiscard]] std::string number_line(const char* key, double value);
/// A number for one value, an array for several.
[[nodiscard]] std::string one_or_many_text(const std::vector<double>& values);
/// A string in quotes, escaped.
[[nodiscard]] std::string quoted_text(const std::string& text);

/// A place as its line of keys, `at` or `between`.
[[nodiscard]] std::string place_toml(const ContactPlace& place);

/// [structure] with its sub-tables; every [[contact]]; [drive].
[[nodiscard]] std::string structure_toml(const Scene& scene);
[[nodiscard]] std::string contacts_toml(const Scene& scene);
[[nodiscard]] std::string drive_toml(const Scene& scene);

}  // namespace slipmode::scene
