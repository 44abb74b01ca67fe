#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/scene/scene.hpp>
#include "fixtures/test_names.hpp"

#include <gtest/gtest.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

/// Texts changed, and what is said about them.
namespace slipmode::tests {

/// The text with the first `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at == std::string::npos) return text;
  return text.replace(at, from.size(), to);
}

/// What an InvalidInput says.
inline std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no InvalidInput";
}

/// What is said about a scene called s.toml.
inline std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return message_of([&] { (void)scene::parse_scene(text, overrides, "s.toml"); });
}

/// The message has file, place, key, value and remedy.
inline void expect_parts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << part << "\nin: " << message;
}

struct BadValue {
  std::string from, to;            ///< change to the text of a scene
  std::vector<std::string> parts;  ///< of the message
};

/// Printed as what is put in: GoogleTest would show the bytes of the strings' pointers, others in every run.
inline void PrintTo(const BadValue& bad, std::ostream* out) { *out << bad.to; }

/// A scene with this change is refused, and the message has the parts.
inline void expect_refused(const std::string& text, const BadValue& bad) {
  expect_parts(error_of(replaced(text, bad.from, bad.to)), bad.parts);
}

inline std::string bad_value_name(const testing::TestParamInfo<BadValue>& info) {
  return fixtures::numbered_name(info.index, info.param.to.empty() ? "no " + info.param.from : info.param.to);
}

/// @throws std::runtime_error  if the file cannot be read
inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace slipmode::tests
