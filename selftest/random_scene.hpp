#pragma once

#include <cstdint>
#include <string>

namespace slipmode::selftest {

/// Text of a valid scene file, drawn at random: the same bytes on every platform.
///
/// Numbers come from Random::stream(seed, index) (core/random.hpp) in the order of the file, so scene `index` of a seed
/// can be made again alone. What is drawn:
/// - structure: a chain, masses on links (some floating), full matrices (damping that is not proportional, at times
/// with
///   a skew part), a beam of one to three elements of either theory; 1 to 12 degrees of freedom, at times up to 60;
///   damping from none to far beyond critical;
/// - one to three contacts, to ground or between masses. Either piecewise-linear laws in any mixture (Coulomb,
/// compliant,
///   clearance of both rules; constant, affine or vibrating normal loads; tilt) or laws at constant load in any mixture
///   (Coulomb, Stribeck, tanh, Dahl, LuGre);
/// - drive: a belt (at rest, constant, ramp), a shaker, a force of up to three harmonics (piecewise-linear laws);
/// - start: rest (but for stops without a gap), random, or contacts exactly on their guard (sliding speed zero).
[[nodiscard]] std::string random_scene_text(std::uint64_t seed, std::uint64_t index);

}  // namespace slipmode::selftest
