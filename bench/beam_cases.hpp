#pragma once

#include "bench/library_cases.hpp"

namespace slipmode::bench {

/// The friction-excited beam beside CVODE and odeint at six frequencies, for three models (beam_models.hpp).
///
/// slipmode is timed over 600 cycles on the attractor. The peers, which would take minutes for that, are timed on
/// stretches spread over the phases of the drive, and so are all errors: those of the state at a stretch's end in the
/// norm of energy, relative to the state, against dopri5 in long double at 1e-14. @param quick  two frequencies
[[nodiscard]] Row measure_beam(bool quick);

/// Sweep of 551 frequencies x 600 cycles on two threads, audit on and off.
/// @param model  index into beam_models: POMF-3, LNM-10, FE-80
/// @param quick  a tenth of the frequencies
[[nodiscard]] Row measure_beam_sweep(std::size_t model, bool quick);

}  // namespace slipmode::bench
