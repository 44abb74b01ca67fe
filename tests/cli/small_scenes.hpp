#pragma once

#include <string>

namespace slipmode::tests {

inline const std::string kBacklash = std::string(SLIPMODE_SOURCE_DIR) + "/datasets/backlash_sdof/scene.toml";
inline const std::string kShakenBeam = std::string(SLIPMODE_SOURCE_DIR) + "/datasets/beam_12hz/scene.toml";

/// Four masses between walls, two Coulomb contacts with μ_s > μ_k, in SI units. Runs of milliseconds.
inline const std::string kTwoContacts = R"(
title = "two contacts"
units = "SI"
[structure]
kind = "chain"
masses = 4
mass = 2.0
stiffness = 50.0
damping = 0.002
ends = "fixed-fixed"
[[contact]]
at = 2
law = "coulomb"
mu_s = 0.5
mu_k = 0.3
normal_load = 8.0
[[contact]]
at = 4
law = "coulomb"
mu_s = 0.4
mu_k = 0.3
normal_load = 5.0
[drive]
kind = "belt"
speed = 0.1
[time]
duration = 40.0
transient = 10.0
sample = 0.05
)";

/// A structure of its own matrices in SI units, slowest period 6 ms, two contacts, an ensemble and no more.
inline const std::string kOwnMatrices = R"(
title = "own matrices"
units = "SI"
[structure]
kind = "matrices"
mass = [[0.2, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.1]]
damping = [[4.0, -2.0, 0.0], [-2.0, 4.0, -2.0], [0.0, -2.0, 2.0]]
stiffness = [[8e5, -4e5, 0.0], [-4e5, 8e5, -4e5], [0.0, -4e5, 4e5]]
[[contact]]
at = 1
law = "coulomb"
mu_s = 0.5
mu_k = 0.3
normal_load = 20.0
[[contact]]
at = 3
law = "coulomb"
mu_s = 0.5
mu_k = 0.3
normal_load = 20.0
[drive]
kind = "belt"
speed = 0.01
[time]
duration = 3.0
transient = 1.0
sample = 0.001
[ensemble]
members = 2
spread = 1e-6
)";

/// Three masses with free ends on ground springs, one Stribeck contact in the middle; all sections of a scene.
inline const std::string kFreeEnds = R"(
title = "free ends"
units = "dimensionless"
[structure]
kind = "chain"
masses = 3
stiffness = 1.0
ground_stiffness = 0.3
damping = 0.01
ends = "free-free"
[[contact]]
at = 2
law = "stribeck"
mu_s = 0.4
mu_k = 0.2
alpha = 5.0
normal_load = 2.0
[drive]
kind = "belt"
speed = 0.2
[time]
duration = 300.0
transient = 100.0
sample = 0.5
[ensemble]
members = 3
seed = 7
spread = 0.1
[reduction]
basis = "pom"
energy = 0.99
[validation]
speeds = { from = 0.4, to = 0.2, step = 0.05 }
transient = 100.0
block = 400.0
limit = 800.0
sweep_limit = 800.0
horizon = 10.0
horizon_starts = 2
orbits = [0.3]
lyapunov_duration = 400.0
cost_duration = 100.0
cost_repeats = 1
)";

}  // namespace slipmode::tests
