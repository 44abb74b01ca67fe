#pragma once

#include <slipmode/fem/structure.hpp>
#include <slipmode/pod/pod.hpp>

#include <vector>

namespace slipmode::rom {

/// POMs of an ensemble and the structure's LNMs, in that order, each with the energy it captures.
///
/// Both are taken about the ensemble's mean, as S4 measures both from the static deflection: so only the directions
/// differ, and LNMs are not charged for a static deflection that a few of them cannot represent.
[[nodiscard]] std::vector<pod::NamedBasis> pom_and_lnm(const fem::Structure& structure, const pod::PodResult& result);

}  // namespace slipmode::rom
