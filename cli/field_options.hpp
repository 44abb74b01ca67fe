#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/studies/command.hpp>

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <type_traits>

namespace slipmode::cli {

/// Refuses what a field may not hold.
[[nodiscard]] CLI::Validator within(const Limits& limits, bool is_integer);

/// An option for each field of an options struct: its name, meaning and limits; of a truth value a flag.
/// @param group  heading in the help; empty: none of its own
template <class S>
void add_fields(CLI::App& command, S& out_values, const std::string& group = "") {
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    const std::string name = studies::option_name(field.name);
    CLI::Option* option = nullptr;
    if constexpr (std::is_same_v<T, bool>) {
      option = command.add_flag(name, out_values.*field.member, field.meaning);
    } else if constexpr (std::is_same_v<T, std::optional<std::string>>) {
      option = command.add_option(name, out_values.*field.member, field.meaning);
    } else {
      option = command.add_option(name, out_values.*field.member, field.meaning)
                   ->check(within(field.limits, std::is_integral_v<T>));
    }
    if (!group.empty()) option->group(group);
  });
}

}  // namespace slipmode::cli
