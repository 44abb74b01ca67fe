#pragma once

#include <slipmode/orbits/branches/continuation.hpp>

namespace slipmode::orbits {

/// True for what `continue_special` follows: folds (non-smooth ones as the grazings they are), period doublings,
/// symmetry breakings, Neimark-Sacker points, grazings.
[[nodiscard]] bool can_be_followed(SpecialKind kind);

/// Range of the key that is solved for, in either order.
struct KeyRange {
  double from = 0.0, to = 1.0;
};

/// Follows a special point of a branch over a second key: a curve in the plane of both, one orbit to a point.
///
/// Unknowns (x₁ … x_m, [ln T], over, along): closing conditions, phase where T is unknown, one condition of the kind,
/// and the distance along the tangent. The condition is
///
///     fold               least singular value of Φ − 1, with column of T and phase row where T is unknown
///     period doubling    least singular value of Φ + 1
///     symmetry breaking  least singular value of 1 − Φ(T/2)
///     Neimark-Sacker     μᵢμⱼ − 1 of the pair whose product is nearest to 1
///     grazing            clearance left where the contact is nearest to its stop, without the touch
///
/// with its derivatives by differences in the two directions in which orbits go on. Curves of folds pass their cusps.
/// A special point of a branch of balances is followed by balances of its order: unknowns as continue_balance, and
///
///     fold               least singular value of Newton's matrix
///     symmetry breaking  that of the even orders' block, along odd ones
///     period doubling    Π (1 + μ), and the pair as above: by Hill's method
///     grazing            clearance at the series' extreme
///
/// so that a curve passes through that order's own special points, not the exact ones.
/// The points' `parameter` is `along`, their `other` is `over`; special points of the curve are cusps, and changes of
/// the word. It is followed both ways from the special point; a curve that closes is followed once.
/// @param family   over (over, along)
/// @param special  of a branch over `over`, at the value `along` of the second key; of its `balance` where it has one
/// @param over     must hold special.parameter; the curve ends at its ends too
/// @param options  range and steps in `along`; `both_ways` is not read
/// @throws InvalidInput  for a kind that cannot be followed, a grazing of something else than a stop, a Hopf point, a
///                       fold or grazing of a family of orbits, a symmetry breaking without its symmetric orbit,
///                       ranges as continue_orbit
[[nodiscard]] Branch continue_special(const dynamics::PlaneFamily& family, const SpecialPoint& special, double along,
                                      const KeyRange& over, const ContinuationOptions& options);

}  // namespace slipmode::orbits
