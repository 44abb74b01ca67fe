#pragma once

#include <slipmode/core/fields.hpp>

#include <tuple>

namespace slipmode::friction {

/// The fields of a law with a static and a kinetic coefficient, mu_s ≥ mu_k.
template <class Law>
constexpr auto coefficients(const Limits& kinetic = kNonNegative) {
  return std::tuple{required("mu_s", &Law::mu_s, "1", "static coefficient", kNonNegative),
                    required("mu_k", &Law::mu_k, "1", "kinetic coefficient", kinetic)};
}

}  // namespace slipmode::friction
