#pragma once

#include <slipmode/dynamics/system.hpp>
#include <slipmode/fem/structure.hpp>
#include <slipmode/pod/pod.hpp>

#include <vector>

namespace slipmode::rom {

/// POMs of an ensemble and the structure's LNMs, in that order, each with the energy it captures.
///
/// Both are taken about the ensemble's mean, as S4 measures both from the static deflection: so only the directions
/// differ, and LNMs are not charged for a static deflection that a few of them cannot represent.
[[nodiscard]] std::vector<pod::NamedBasis> pom_and_lnm(const fem::Structure& structure, const pod::PodResult& result);

/// A static mode per contact and LNMs (see lnm_static_basis), as many as degrees of freedom, about the same mean.
/// @throws InvalidInput  for a structure that floats
[[nodiscard]] pod::NamedBasis lnm_and_static(const dynamics::HybridSystem& system, const pod::PodResult& result);

}  // namespace slipmode::rom
