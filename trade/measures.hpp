#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slipmode::trade {

/// What one configuration is compared by. All in percent, so that one limit can be asked of any.
enum class Measure : std::size_t {
  kDx,      ///< S4's ΔX up to the horizon, from shared starts
  kDe,      ///< S4's ΔE there
  kPoints,  ///< Wasserstein-1 distance of slip states (sections of a shaker, a force), of the reading's rms
  kSpread,  ///< the same of the reading over all times
  kEnergy,  ///< mean energy of the settled motion
  kStick,   ///< share of the time in stick, in percentage points
};
inline constexpr std::size_t kMeasures = 6;

/// "dX", "dE", "points", "spread", "energy", "stick": the word of tables and of --measure.
[[nodiscard]] std::string_view to_string(Measure measure);
/// One line about it.
[[nodiscard]] std::string_view describe(Measure measure);

/// What is asked of a model. Paths of a chaotic motion part whatever is left out, its statistics need not.
enum class Question : std::uint8_t {
  kMotion,      ///< where everything is, up to the horizon: kDx, kDe
  kStatistics,  ///< attractor and response of the settled motion: kPoints … kStick
};

/// "motion", "statistics".
[[nodiscard]] std::string_view to_string(Question question);
/// The question that a measure is part of the answer to.
[[nodiscard]] constexpr Question question_of(Measure measure) {
  return measure == Measure::kDx || measure == Measure::kDe ? Question::kMotion : Question::kStatistics;
}

/// One value per measure; NaN where it says nothing (a law without stick has no slip states).
using Values = std::array<double, kMeasures>;

[[nodiscard]] inline double& at(Values& values, Measure measure) { return values[static_cast<std::size_t>(measure)]; }
[[nodiscard]] inline double at(const Values& values, Measure measure) {
  return values[static_cast<std::size_t>(measure)];
}

}  // namespace slipmode::trade
