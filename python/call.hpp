#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/core/fields.hpp>
#include <slipmode/core/parallel.hpp>
#include <slipmode/studies/run_options.hpp>

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

// How Python's keywords become the options of a study, and how a study runs beside Python.

namespace slipmode::python {

namespace py = pybind11;

/// A name as a keyword of Python: one that is a word of its grammar ends in an underscore.
[[nodiscard]] std::string python_name(const std::string& name);

/// What a call was given beyond its own arguments: options by the names of their field lists. Each is taken once; what
/// nobody took is refused.
class Keywords {
 public:
  Keywords(std::string call, const py::kwargs& given) : call_(std::move(call)), given_(py::dict(given)) {}

  /// All fields of an options struct that were given. @throws InvalidInput  for a value that is not one of the field's
  template <class S>
  void read(S& own) {
    for_each_field<S>([&](const auto& field) {
      known_.push_back(python_name(field.name));
      const py::object value = take(field.name);
      if (value) own.*field.member = checked(field, value);
    });
  }

  /// Null when it was not given, or is None.
  [[nodiscard]] py::object take(const std::string& name);
  /// Text, or what stands where it was not given.
  [[nodiscard]] std::string text(const char* name, std::string otherwise = {});
  /// `output`, the file that a long study writes; empty: none. @throws InvalidInput  where no file can be made
  [[nodiscard]] std::string output();
  /// @throws InvalidInput  for what nobody took
  void finish() const;
  [[noreturn]] void refuse(const std::string& name, const py::handle& value, const std::string& expected) const;

 private:
  template <class S, class T>
  [[nodiscard]] T checked(const Field<S, T>& field, const py::object& value) const {
    if constexpr (std::is_same_v<T, bool>) {
      if (!py::isinstance<py::bool_>(value)) refuse(field.name, value, "True or False");
      return value.cast<bool>();
    } else if constexpr (std::is_integral_v<T> || std::is_same_v<T, std::optional<int>>) {
      using Limit = std::conditional_t<std::is_integral_v<T>, T, int>;
      std::int64_t number = 0;
      const bool whole = PyIndex_Check(value.ptr()) != 0 && !py::isinstance<py::bool_>(value) &&
                         py::detail::make_caster<std::int64_t>().load(value, true);
      if (whole) number = value.cast<std::int64_t>();
      const double high = std::min(field.limits.high, static_cast<double>(std::numeric_limits<Limit>::max()));
      if (!whole || static_cast<double>(number) < field.limits.low || static_cast<double>(number) > high)
        refuse(field.name, value, integer_text(field.limits));
      return static_cast<Limit>(number);
    } else if constexpr (std::is_same_v<T, std::optional<std::string>>) {
      const bool number = PyIndex_Check(value.ptr()) != 0 || py::isinstance<py::float_>(value);
      if (py::isinstance<py::bool_>(value) || (!py::isinstance<py::str>(value) && !number))
        refuse(field.name, value, "a number or a word");
      return py::str(value).cast<std::string>();
    } else {
      static_assert(std::is_same_v<T, double> || std::is_same_v<T, std::optional<double>>);
      py::detail::make_caster<double> number;
      if (!number.load(value, true) || !field.limits.hold(static_cast<double>(number)))
        refuse(field.name, value, field.limits.text);
      return static_cast<double>(number);
    }
  }

  std::string call_;
  py::dict given_;
  std::vector<std::string> known_;
};

/// A field's meaning and unit for a docstring.
template <class S, class T>
[[nodiscard]] std::string meaning_text(const Field<S, T>& field) {
  return *field.unit == '\0' ? field.meaning : fmt::format("{} [{}]", field.meaning, field.unit);
}

/// What Python calls the type of an option.
template <class T>
[[nodiscard]] constexpr const char* type_text() {
  if constexpr (std::is_same_v<T, bool>) return "bool";
  if constexpr (std::is_integral_v<T> || std::is_same_v<T, std::optional<int>>) return "int";
  if constexpr (std::is_same_v<T, std::optional<std::string>>) return "str | float";
  return "float";
}

/// The fields of an options struct as lines of a docstring, "    name (type): meaning (default x)". The package makes
/// signatures of them; one without a default is None where it is not given.
template <class S>
[[nodiscard]] std::string options_text() {
  const S own;
  std::string text;
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    const py::object value = py::cast(own.*field.member);
    text += fmt::format("    {} ({}): {}{}\n", python_name(field.name), type_text<T>(), meaning_text(field),
                        value.is_none() ? "" : fmt::format(" (default {})", std::string(py::str(value))));
  });
  return text;
}

/// A study run without Python's lock: Ctrl-C ends it with KeyboardInterrupt, its progress goes to a Python function.
class Call {
 public:
  /// Takes `threads` and `progress` (a function of part, done, total; called at most ten times a second, from 0.3 s
  /// on).
  explicit Call(Keywords& keywords);
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  [[nodiscard]] const studies::RunOptions& options() const { return options_; }

  /// work(), without Python's lock. @throws py::error_already_set  for KeyboardInterrupt, and what progress raised
  template <class Work>
  auto operator()(const Work& work) {
    try {
      auto result = [&] {
        const py::gil_scoped_release unlocked;
        return work();
      }();
      raise_progress_error();
      return result;
    } catch (const Interrupted&) {
      raise_interrupt();
    }
  }

 private:
  struct Progress;
  [[noreturn]] void raise_interrupt() const;
  void raise_progress_error() const;

  studies::RunOptions options_;
  int slot_;
  std::shared_ptr<Progress> progress_;
};

/// Says where Python's documentation of a call has its options: what they share.
[[nodiscard]] std::string call_text();

}  // namespace slipmode::python
