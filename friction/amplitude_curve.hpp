#pragma once

#include <slipmode/core/fields.hpp>

#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace slipmode::friction {

/// A shaker's amplitude as a function of its frequency f [Hz]: what an amplifier at constant gain gives depends on f.
/// (S4 chapter 6 shows its curve as a figure only and calls it exponential.)
struct AmplitudeCurve {
  /// The same at every frequency.
  struct Constant {
    double amplitude = 0.0;  ///< ≥ 0 [m]
  };
  /// a0 + a1 f + a2 f² + …
  struct Polynomial {
    std::vector<double> coefficients;  ///< a0, a1, … [m, m/Hz, …], not empty
  };
  /// Straight lines between points; no value outside them.
  struct Table {
    std::vector<std::pair<double, double>> points;  ///< (f, amplitude), at least two, f ascending, amplitude ≥ 0
  };
  /// amplitude · e^{−(f − at)/decay}
  struct Exponential {
    double at = 0.0, amplitude = 0.0, decay = 1.0;

    static constexpr auto fields() {
      return std::tuple{required("at", &Exponential::at, "Hz", "a frequency"),
                        required("amplitude", &Exponential::amplitude, "m", "at that frequency", kNonNegative),
                        required("decay", &Exponential::decay, "Hz", "over which it falls to 1/e", kPositive)};
    }
  };

  std::variant<Constant, Polynomial, Table, Exponential> kind = Constant{};

  /// Amplitude at a frequency [m].
  /// @throws InvalidInput  for a frequency that is not positive or outside a table, or a curve that is negative or not
  ///                       finite there
  [[nodiscard]] double at(double frequency_hz) const;
  /// True when the curve has a value ≥ 0 at every frequency between the two, in either order.
  [[nodiscard]] bool covers(double from_hz, double to_hz) const;
};

/// @throws InvalidInput  naming what is wrong with the curve's own numbers (see its alternatives)
void validate(const AmplitudeCurve& curve);

}  // namespace slipmode::friction
