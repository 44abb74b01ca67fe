#pragma once

#include "scene/messages.hpp"

#include <string>

namespace slipmode::tests {

/// The contact and the amplitude curve of kBeamScene, to be replaced.
inline const std::string kBeamLaw =
    "law = \"compliant\"\nmu_k = 0.55\nmu_s = 0.748\nstiffness = 20e3\n"
    "normal_load = { constant = 0.345, slope = -1.54 }\ntilt_deg = 0.312\n";
inline const std::string kBeamCurve = "{ exponential = { at = 5.0, amplitude = 3.0e-3, decay = 20.0 } }";

/// A shaken beam with a value for every key.
inline const std::string kBeamScene = R"(title = "beam"
units = "SI"
[structure]
kind = "beam"
theory = "euler-bernoulli"
length = 0.4
width = 0.0128
thickness = 0.00086
youngs_modulus = 128e9
density = 7488
elements = 8
[structure.tip]
mass = 0.015
inertia = 1e-6
offset = 0.01
extension = 0.064
[structure.damping]
modal_ratio = 0.01
[[contact]]
at = "tip"
law = "compliant"
mu_k = 0.55
mu_s = 0.748
stiffness = 20e3
normal_load = { constant = 0.345, slope = -1.54 }
tilt_deg = 0.312
[drive]
kind = "shaker"
frequency = 12.5
phase = 0.25
amplitude = { exponential = { at = 5.0, amplitude = 3.0e-3, decay = 20.0 } }
[time]
cycles = 20
transient_cycles = 4
samples_per_cycle = 16
[ensemble]
members = 2
seed = 5
spread = 1e-4
frequencies = [12.0, 41.1]
[sensors]
kind = "strain"
x = [0.3, 0.2, 0.05]
noise = 0.01
seed = 3
[reduction]
basis = "pomf"
fit = "polynomial"
functions = 3
modes = 2
[validation]
frequencies = { from = 5.0, to = 60.0, step = 0.1 }
cycles = 60
kept = 50
gauge = 0.1
modes = [1, 2]
bases = ["pomf", "lnm+static"]
follow = "both"
cost_cycles = 100
cost_repeats = 3
)";

/// The same beam on a belt, starting in sliding equilibrium.
inline const std::string kBeamOnBelt =
    kBeamScene.substr(0, kBeamScene.find("[drive]")) +
    "[drive]\nkind = \"belt\"\nspeed = 0.2\n[time]\nduration = 3\n[initial]\nat = \"static\"\n";

}  // namespace slipmode::tests
