#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/scene/scene.hpp>
#include "report/internal/json.hpp"

#include <Eigen/Core>
#include <vector>

namespace slipmode::report {

/// Of larger structures no motion is shown: their states would fill the memory, not the page.
inline constexpr Eigen::Index kMostDrawnDofs = 2000;

/// A structure as it is drawn: points along a line, and what is read there from the full degrees of freedom.
struct DrawnStructure {
  Json about;                ///< kind, x of the points, fixed ends, contacts with their x
  Eigen::MatrixXd readings;  ///< displacements of the points [points x n]
};

/// Up to 24 points: masses of a chain or degrees of freedom, those at contacts among them, or places along a beam from
/// its clamp to its reach.
[[nodiscard]] DrawnStructure drawn_structure(const scene::Scene& scene);

/// Displacements of the points over time, one list per point, to a 250th of their span: less than a pixel.
/// @param shapes  [points x instants]
[[nodiscard]] Json shapes_json(const Eigen::MatrixXd& shapes);

/// What each contact does as [time, mode] pairs, the first at 0. @param events  in time order
/// @param modes  what a contact without events does
/// @param start  what times are counted from
[[nodiscard]] Json contact_modes_json(const std::vector<dynamics::Event>& events,
                                      const std::vector<dynamics::ContactMode>& modes, double start);

}  // namespace slipmode::report
