#pragma once

#include <slipmode/scene/scene.hpp>
#include "report/internal/json.hpp"

#include <Eigen/Core>

namespace slipmode::report {

/// A structure as it is drawn: points along a line, and what is read there from the full degrees of freedom.
struct DrawnStructure {
  Json about;                ///< kind, x of the points, fixed ends, contacts with their x
  Eigen::MatrixXd readings;  ///< displacements of the points [points x n]
};

/// Up to 24 points: masses of a chain or degrees of freedom, those at contacts among them, or places along a beam from
/// its clamp to its reach.
[[nodiscard]] DrawnStructure drawn_structure(const scene::Scene& scene);

}  // namespace slipmode::report
