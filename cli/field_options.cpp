#include "cli/field_options.hpp"

#include <slipmode/core/numbers.hpp>

#include <fmt/format.h>

namespace slipmode::cli {

CLI::Validator within(const Limits& limits, bool is_integer) {
  const auto check = [limits, is_integer](const std::string& text) {
    const auto value = number_in<double>(text);
    if (value && limits.hold(*value)) return std::string();
    return fmt::format("{}: expected {}", text, is_integer ? integer_text(limits) : limits.text);
  };
  return {check, ""};
}

}  // namespace slipmode::cli
