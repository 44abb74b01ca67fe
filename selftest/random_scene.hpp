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
///   a skew part), a beam of one or two spans of either theory; 1 to 12 degrees of freedom, at times up to 200; damping
///   of every kind, from none to far beyond critical; at times stiff and slow mixed, springs up to 1e6 times one
///   another;
/// - one to six contacts, to ground or between masses, at times a stop beside another one. Either piecewise-linear laws
///   in any mixture (Coulomb, compliant, clearance of both rules, springs and stops up to 1e6 times the structure's;
///   constant, affine or vibrating normal loads; tilt), by either flow, or any of those but vibrating loads beside laws
///   of the sliding speed (Stribeck, tanh, Dahl, LuGre), or Coulomb's alone by collocation;
/// - drive: a belt (at rest, constant, ramp), a shaker (amplitude a number or a curve), a force of up to six harmonics
/// in
///   several places with a mean;
/// - start: rest (but for stops without a gap), static, random, or contacts exactly on their guards.
[[nodiscard]] std::string random_scene_text(std::uint64_t seed, std::uint64_t index);

}  // namespace slipmode::selftest
