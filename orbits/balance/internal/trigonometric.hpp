#pragma once

#include <slipmode/orbits/spectrum.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::orbits {

/// y(θ) = Re(p_0 + Σ_{k=1}^{H} p_k e^{ikθ}) by its phasors p = cosine − i sine.
struct TrigonometricPolynomial {
  Eigen::VectorXcd phasors;  ///< [H + 1]

  struct Value {
    double y = 0.0, slope = 0.0;
  };
  /// y and dy/dθ.
  [[nodiscard]] Value at(double theta) const;
};

[[nodiscard]] TrigonometricPolynomial polynomial_of(const Harmonics& y);

/// y at `points` angles at equal distances around the circle, from one on: all at once, which takes a tenth of the time
/// of one by one.
[[nodiscard]] Eigen::RowVectorXd values_around(const TrigonometricPolynomial& y, double first, int points);

/// dy/dθ.
[[nodiscard]] TrigonometricPolynomial derivative(const TrigonometricPolynomial& y);

/// All zeros in [0, 2π), ascending. The circle is halved until each part is proved free of zeros, or monotone and then
/// has one where its ends differ in sign: |y(θ) − y(m) − y′(m)(θ − m)| ≤ ½ Σ k²|p_k| (θ − m)². Parts shorter than 1e-9
/// rad that are still undecided hold a pair of zeros or a touch: a pair is left out, which no integral over the part
/// can see.
[[nodiscard]] std::vector<double> zeros(const TrigonometricPolynomial& polynomial);

/// The zero between two angles, to rounding, where there is one alone. @param negative  the polynomial is at `low`
[[nodiscard]] double zero_between(const TrigonometricPolynomial& polynomial, double low, bool negative, double high);

}  // namespace slipmode::orbits
