#pragma once

#include <slipmode/diagnostics/attractors/driven_sweep.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/beam.hpp>
#include <slipmode/pod/basis.hpp>
#include <slipmode/trade/variant.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace slipmode::trade {

/// A variant ready to run. The one reading is the curvature at the gauge of a shaken beam (the strain gauge's, up to
/// half the thickness), elsewhere the first contact's displacement.
struct Case {
  diagnostics::DrivenCase model;          ///< what runs
  dynamics::HybridSystem full;            ///< before projection; `model.system` itself without a basis
  std::optional<pod::Basis> basis;        ///< of a reduced model
  std::shared_ptr<const fem::Beam> beam;  ///< the mesh of a beam; null otherwise
  dynamics::FlowOptions flow;             ///< no energy audit
};

/// @throws InvalidInput  as scene::build_system and rom::reduce, and for a basis that is not on offer
[[nodiscard]] Case build_case(const Variant& variant, const std::vector<OfferedBasis>& bases);

/// A state of one case as the nearest one of another: lifted, taken over to another mesh by the values and slopes at
/// its nodes, projected. Contact modes are left to be derived; contacts' own states are kept where both have the same
/// laws, else left relaxed.
[[nodiscard]] dynamics::State handed_on(const Case& from, const Case& to, const dynamics::State& state);

}  // namespace slipmode::trade
