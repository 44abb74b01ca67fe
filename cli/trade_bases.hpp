#pragma once

#include <slipmode/trade/variant.hpp>
#include "cli/session.hpp"

#include <vector>

namespace slipmode::cli {

/// The bases that a scene's reduced models can have, each with the processor time that making it took: under a shaker
/// those of validation.bases, elsewhere POMs and LNMs about the mean of the ensemble. Natural modes alone where the
/// ensemble gives no modes (it does not move), none for one degree of freedom.
[[nodiscard]] std::vector<trade::OfferedBasis> offered_bases(const Session& session, const scene::Scene& scene);

}  // namespace slipmode::cli
