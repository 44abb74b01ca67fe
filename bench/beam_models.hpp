#pragma once

#include <slipmode/diagnostics/attractors/driven_sweep.hpp>
#include <slipmode/scene/scene.hpp>

#include <string>
#include <vector>

namespace slipmode::bench {

/// What the project asks of kernels of eight doubles; 0: nothing.
struct WantedBeam {
  double odeint = 0.0;             ///< ratio to dopri5 while the tip slips
  double tight = 0.0;              ///< the same to dopri5 at 1e-12
  double sweep_cpu_seconds = 0.0;  ///< of the sweep of 551 frequencies
};

/// One model of the friction-excited beam.
struct BeamModel {
  std::string name;
  diagnostics::DrivenCase shaken;  ///< read at the scene's gauge
  int stretches = 8;               ///< on which peers are timed and errors taken, evenly over the phases of the drive
  double stretch = 10.0;           ///< their length, in cycles
  WantedBeam wanted = {};
};

/// The scene of datasets/beam_sweep.
[[nodiscard]] scene::Scene beam_scene();

/// Three proper orthogonal modal functions from six gauges at 12 Hz (one run, 100 cycles after 100), ten linear natural
/// modes, and the finite elements themselves.
[[nodiscard]] std::vector<BeamModel> beam_models(const scene::Scene& scene);

}  // namespace slipmode::bench
