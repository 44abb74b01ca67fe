#pragma once

#include <string>

namespace slipmode::results {

/// Units of stored and drawn quantities: SI, or "1" for all in a dimensionless scene.
struct Units {
  std::string length = "1", velocity = "1", force = "1", time = "1", rate = "1", energy = "1", angular = "1",
              frequency = "1", stiffness = "1";

  /// In prose, several and one: seconds, or what a dimensionless scene has for them.
  [[nodiscard]] std::string times() const { return time == "1" ? "units of time" : time; }
  [[nodiscard]] std::string one_time() const { return time == "1" ? "unit of time" : time; }

  /// Of information lost or gained.
  [[nodiscard]] std::string bit_rate() const { return time == "1" ? "bit per unit of time" : "bit/" + time; }

  /// @param system  a scene's `units`: "SI" or "dimensionless"
  [[nodiscard]] static Units of(const std::string& system) {
    if (system != "SI") return {};
    return {.length = "m",
            .velocity = "m/s",
            .force = "N",
            .time = "s",
            .rate = "1/s",
            .energy = "J",
            .angular = "rad/s",
            .frequency = "Hz",
            .stiffness = "N/m"};
  }
};

}  // namespace slipmode::results
