#pragma once

#include <slipmode/trade/variant.hpp>

#include <string>
#include <vector>

namespace slipmode::trade {

/// Degrees of freedom up to which a beam's reference has twice the scene's elements.
inline constexpr Eigen::Index kAffordableSize = 200;
/// Tolerance of the reference's flow, where it has one.
inline constexpr double kReferenceTolerance = 1e-12;

/// The best affordable model of what the scene says: its own physics, all degrees of freedom, the closed-form flow or a
/// tolerance of 1e-12, twice the elements of a beam (see kAffordableSize). Its name says which.
[[nodiscard]] Variant reference_of(const scene::Scene& scene);

/// The scene as it stands.
[[nodiscard]] Variant as_it_stands(const scene::Scene& scene);

/// The axes that a scene has, in the order of Axis. With two degrees of freedom there are modes to choose.
[[nodiscard]] std::vector<Axis> axes_of(const scene::Scene& scene);

/// Words of --axes. @throws InvalidInput  for an unknown one, or one that the scene does not have; both name the valid
[[nodiscard]] std::vector<Axis> parse_axes(const std::string& words, const std::vector<Axis>& available);

/// The configurations along one axis, the scene's own value left out; none on those of periodic orbits (orbit_methods).
/// Flows, laws and loads are those that the contacts can have: a tilted contact has no regularised law. On kModes every
/// basis with every number of modes asked for in [validation], by default 1 to its size, thinned to at most twelve.
[[nodiscard]] std::vector<Variant> along(Axis axis, const scene::Scene& scene, const std::vector<OfferedBasis>& bases);

/// 1 to `size`, thinned evenly by ratio to at most twelve numbers, ascending. None for a size below 1.
[[nodiscard]] std::vector<Eigen::Index> thinned_sizes(Eigen::Index size);

/// A reduced model with another flow. @param reduced  of kModes  @param flow  of kFlow
[[nodiscard]] Variant combined(const Variant& reduced, const Variant& flow);

/// Every reduced model with every flow of `variants`.
[[nodiscard]] std::vector<Variant> product(const std::vector<Variant>& variants);

}  // namespace slipmode::trade
