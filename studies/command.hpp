#pragma once

#include <slipmode/core/fields.hpp>

#include <fmt/format.h>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace slipmode::studies {

/// A key and its values.
struct Over {
  std::string key;
  std::vector<double> values;
};

/// "--max-order" of the field max_order.
[[nodiscard]] std::string option_name(const char* field);

/// The options of a command that are not as they start, each with a blank before it: " --max-order 4 --follow".
template <class S>
[[nodiscard]] std::string options_text(const S& own) {
  const S usual;
  std::string text;
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    if (own.*field.member == usual.*field.member) return;
    text += " " + option_name(field.name);
    if constexpr (requires(T value) { value.has_value(); })
      text += fmt::format(" {}", *(own.*field.member));
    else if constexpr (!std::is_same_v<T, bool>)
      text += fmt::format(" {}", own.*field.member);
  });
  return text;
}

/// " --model pomf:3"; nothing for the full model.
[[nodiscard]] std::string model_option(const std::string& model);

/// "drive.speed=0.5:0.001:0.001". Values that no such range gives are named by their number, ends and a fingerprint.
[[nodiscard]] std::string over_text(const Over& over);

/// What was asked, as the executable would be asked, for provenance and for journals: whoever asks for the same gets
/// the same text.
/// @param options  as options_text
[[nodiscard]] std::string command_text(const std::string& verb, const std::vector<Over>& over,
                                       const std::string& options);

}  // namespace slipmode::studies
