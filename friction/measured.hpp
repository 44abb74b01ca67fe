#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/friction/contact_forces.hpp>

#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace slipmode::friction {

/// Rigid friction with a characteristic given by points: in slip λ = N μ(|v_rel|) sign(v_rel), in stick |λ| ≤ μ_s N.
///
/// μ is the monotone cubic through the points: between two of them it stays between their values, its slope is
/// continuous, and it is flat at a point that is higher or lower than both neighbours. From the last point on it keeps
/// that point's value. Source: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300, with the weights of
/// unequal intervals; the slope at v = 0 is that of the first two points.
struct Measured {
  double mu_s = 0.0;                      ///< ≥ the first coefficient
  std::vector<double> speeds = {};        ///< of the points, from 0, ascending, two at least [m/s]
  std::vector<double> coefficients = {};  ///< μ at these, ≥ 0

  static constexpr const char* word = "table";
  static constexpr auto fields() {
    return std::tuple{
        required("mu_s", &Measured::mu_s, "1", "static coefficient", kNonNegative),
        required("speeds", &Measured::speeds, "m/s", "sliding speeds of the points, ascending from 0", kNonNegative),
        required("coefficients", &Measured::coefficients, "1", "friction coefficients at these speeds", kNonNegative)};
  }

  [[nodiscard]] LawKind kind() const { return kind_by_speed(mu_s); }
  [[nodiscard]] double static_coefficient() const { return mu_s; }
  [[nodiscard]] double limit_coefficient() const { return coefficients.back(); }
  [[nodiscard]] double kinetic_coefficient(double speed) const;
  [[nodiscard]] double fastest_rate(const Pace& pace) const;
  [[nodiscard]] ContactForces forces(double normal_load) const;
};

/// What is wrong with a law's numbers beyond the limits of each.
struct LawFault {
  const char* field;     ///< whose value it is
  std::string found;     ///< "3 coefficients for 4 speeds"
  std::string expected;  ///< "one per speed"
};
/// The first, if any.
[[nodiscard]] std::optional<LawFault> fault_of(const Measured& law);

}  // namespace slipmode::friction
