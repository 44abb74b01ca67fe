#pragma once

#include <slipmode/scene/scene.hpp>

#include <string>
#include <vector>

namespace slipmode::scene {

/// The scene with the times of a belt's [validation] that it does not give taken from its structure's slowest natural
/// period T₁, contacts slipping: transient 24 T₁, block and sweep_limit 120, limit 2400, horizon 2.4, lyapunov_duration
/// 480, cost_duration 240, each to one digit; and the speeds, where it gives none, in steps of a twentieth of its own
/// up to 2.5 times that. Where no law sticks there are no slips whose return tells a period, and waiting tells no more:
/// limit is one block. Unchanged without a belt, and where nothing vibrates.
[[nodiscard]] Scene with_own_times(Scene scene);

/// Period of the structure's slowest mode that vibrates, contacts slipping [s]; 0 where there is none among the first.
[[nodiscard]] double slowest_period(const Scene& scene);

/// A time to one digit; 0 of 0.
[[nodiscard]] double to_one_digit(double time);

/// True when a contact's law holds it on its counterpart; tanh, Dahl's and LuGre's do not, nor does a clearance.
[[nodiscard]] bool has_sticking_law(const Scene& scene);

/// Times that a scene leaves to a period of its own.
struct ChosenTimes {
  struct Time {
    std::string key;  ///< "time.sample"
    double value = 0.0;
  };
  std::string of = {};  ///< which period
  double period = 0.0;  ///< [s]
  std::vector<Time> times = {};
};

/// What was chosen of these tables and keys: "time", "validation", "validation.block".
/// @param scene  as with_own_times gives it
[[nodiscard]] ChosenTimes chosen_times(const Scene& scene, const std::vector<std::string>& names);

}  // namespace slipmode::scene
