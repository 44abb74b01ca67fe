#pragma once

// A random scene being written: what random_structure.cpp, random_contacts.cpp and random_scene.cpp add their tables
// to.

#include <slipmode/core/random.hpp>

#include <fmt/format.h>
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slipmode::selftest {

struct SceneDraft {
  Random random;
  std::string text{};

  int dofs = 1;
  bool beam = false, floats = false;
  std::vector<double> nodes{};  ///< of a beam, without its clamp: x [m]
  /// Typical spring, rate and displacement. They make friction matter: forces of the order of a spring times a
  /// displacement.
  double stiffness = 1.0, rate = 1.0, size = 1.0;
  double pressed = 1.0;  ///< normal loads and joints' limits, as a share of such forces
  bool mixed = false;    ///< stiff and slow: springs up to a million times one another
  bool light = false;    ///< masses down to a thousandth of one another

  bool linear = false;                          ///< of piecewise-linear laws alone
  bool varying = false, oscillates = false;     ///< a normal load is not constant; has an oscillator
  bool clearances = false, closed = false;      ///< has some; has one without a gap
  bool coulomb_alone = false;                   ///< no other law, but for what joins at its place
  std::vector<int> places{};                    ///< masses of the contacts, or nodes
  std::vector<std::pair<int, double>> stops{};  ///< mass and displacement at which it meets a stop
  bool belt = false;
  double counterpart = 0.0;  ///< its speed at the start

  [[nodiscard]] int masses() const { return beam ? dofs / 2 : dofs; }
  [[nodiscard]] double speed() const { return size * rate; }

  double uniform(double low, double high) { return random.uniform(low, high); }
  double scatter(double low, double high) { return low * std::exp(uniform(0.0, std::log(high / low))); }
  bool chance(double p) { return random.uniform() < p; }
  int integer(int low, int high) { return low + static_cast<int>(random.uniform() * (high - low + 1)); }
  std::vector<double> values(int count, double low, double high) {
    std::vector<double> result(static_cast<std::size_t>(count));
    for (double& value : result) value = uniform(low, high);
    return result;
  }
  std::vector<double> masses_of(int count) {
    std::vector<double> result = values(count, 0.3, 2.5);
    if (light)
      for (double& mass : result)
        if (chance(0.3)) mass *= scatter(1e-3, 1.0);
    return result;
  }
  /// A spring constant between these, or far from them where stiff and slow are mixed.
  double spring(double low, double high) { return uniform(low, high) * (mixed ? scatter(1e-3, 1e3) : 1.0); }
  /// One side of a clearance.
  void stop(std::string_view side, double own_stiffness, double damping, double gap) {
    line("{} = {{ stiffness = {}, damping = {}, gap = {} }}", side, number(own_stiffness), number(damping),
         number(gap));
  }
  /// A contact's own spring: of the structure's order to far beyond it.
  double contact_spring(double usual, double most) { return stiffness * scatter(1.0, chance(0.1) ? most : usual); }

  template <class... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    text += fmt::format(format, std::forward<Args>(args)...) + "\n";
  }
  void key(const char* name, double value) { line("{} = {}", name, number(value)); }
  /// A line with a number in place of each '#'. A braced list is evaluated from left to right, arguments are not.
  void fill(std::string_view format, std::initializer_list<double> values_in) {
    const double* value = values_in.begin();
    for (const char c : format) text += c == '#' ? number(*value++) : std::string(1, c);
    text += '\n';
  }

  /// A number as TOML writes a float.
  static std::string number(double value) {
    std::string digits = fmt::format("{}", value);
    if (digits.find_first_of(".e") == std::string::npos) digits += ".0";
    return digits;
  }
  static std::string numbers(const std::vector<double>& values) {
    std::string list = "[";
    for (const double value : values) list += (list.size() > 1 ? ", " : "") + number(value);
    return list + "]";
  }
};

/// [structure] and what belongs to it, `units` before it.
void write_structure(SceneDraft& draft);
/// One to five [[contact]].
void write_contacts(SceneDraft& draft);
/// [drive].
void write_drive(SceneDraft& draft);
/// Structure, contacts and drive of a chain at rest: friction holds one of its masses off, and stops of others are just
/// where they are then.
/// @return its displacements
[[nodiscard]] std::vector<double> write_resting_chain(SceneDraft& draft);

}  // namespace slipmode::selftest
