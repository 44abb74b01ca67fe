#include <slipmode/fem/beam.hpp>

#include <slipmode/core/errors.hpp>
#include "fem/internal/beam_damping.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace slipmode::fem {

namespace {

using detail::BeamElement;

constexpr double kNodeTolerance = 1e-9;  // of an element's length: a position this close to a node counts as the node
constexpr double kEndTolerance = 1e-12;  // of the length: positions computed by arithmetic miss the ends by rounding

BeamOptions checked(BeamOptions options) {
  detail::check_beam_options(options, detail::effects_of(options.theory));
  return options;
}

std::vector<double> node_positions(const BeamOptions& options) {
  std::vector<double> nodes = {0.0};
  double start = 0.0;
  for (const BeamSpan& span : options.spans) {
    for (int i = 1; i <= span.elements; ++i) nodes.push_back(start + span.length * i / span.elements);
    start += span.length;
  }
  return nodes;
}

Structure assemble(const BeamOptions& options, const std::vector<BeamElement>& elements) {
  std::vector<std::string> names;
  for (std::size_t node = 1; node <= elements.size(); ++node) {
    names.push_back(fmt::format("y{}", node));
    names.push_back(fmt::format("theta{}", node));
  }
  return detail::damped_beam(detail::assemble_beam(elements, options.tip), options.damping, std::move(names));
}

double checked_position(const char* row, double x, double end, const char* end_name) {
  const double slack = kEndTolerance * end;
  if (!(x >= -slack && x <= end + slack)) {
    throw InvalidInput(
        fmt::format("beam: {} at x = {:.12g} m; expected 0 <= x <= {:.12g} m ({})", row, x, end, end_name));
  }
  return std::clamp(x, 0.0, end);
}

// An element and the place in it, ξ = 0 at its left node, 1 at its right one.
struct Place {
  std::size_t element;
  double xi;
};

// The one or, at a node between elements, two places that x stands for.
std::vector<Place> places(double x, const std::vector<double>& nodes) {
  const auto right = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, x);
  const auto element = static_cast<std::size_t>(right - nodes.begin()) - 1;
  const double xi = std::clamp((x - nodes[element]) / (nodes[element + 1] - nodes[element]), 0.0, 1.0);
  if (xi <= kNodeTolerance && element > 0) return {{element - 1, 1.0}, {element, 0.0}};
  if (xi >= 1.0 - kNodeTolerance && element + 2 < nodes.size()) return {{element, 1.0}, {element + 1, 0.0}};
  return {{element, xi}};
}

// Mean over the places of the element's functions, in the dofs of the structure (those at the clamp left out).
template <typename Functions>
Eigen::VectorXd mean_row(const std::vector<Place>& at, const std::vector<BeamElement>& elements,
                         const Functions& functions) {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(elements.size()));
  for (const auto& [element, xi] : at) {
    const Eigen::RowVector4d local = functions(elements[element], xi) / static_cast<double>(at.size());
    const auto left = 2 * (static_cast<Eigen::Index>(element) - 1);
    if (element > 0) row.segment<2>(left) += local.head<2>().transpose();
    row.segment<2>(left + 2) += local.tail<2>().transpose();
  }
  return row;
}

}  // namespace

Beam::Beam(BeamOptions options)
    : options_(checked(std::move(options))),
      elements_(detail::beam_elements(options_, detail::effects_of(options_.theory))),
      nodes_(node_positions(options_)),
      structure_(assemble(options_, elements_)) {
  length_ = nodes_.back();
}

Eigen::VectorXd Beam::displacement_row(double x) const {
  x = checked_position("displacement", x, reach(), "the end of the rigid extension");
  Eigen::VectorXd row = mean_row(places(std::min(x, length_), nodes_), elements_, detail::displacement_functions);
  if (x > length_) row(row.size() - 1) += x - length_;
  return row;
}

Eigen::VectorXd Beam::slope_row(double x) const {
  x = checked_position("slope", x, reach(), "the end of the rigid extension");
  if (x > length_) return Eigen::VectorXd::Unit(structure_.size(), structure_.size() - 1);
  return mean_row(places(x, nodes_), elements_, detail::slope_functions);
}

Eigen::VectorXd Beam::curvature_row(double x) const {
  x = checked_position("curvature", x, reach(), "the end of the rigid extension");
  if (x > length_) return Eigen::VectorXd::Zero(structure_.size());
  return mean_row(places(x, nodes_), elements_, detail::curvature_functions);
}

Eigen::VectorXd Beam::strain_row(double x) const {
  x = checked_position("strain", x, length_, "the end of the beam");
  return mean_row(places(x, nodes_), elements_, [](const BeamElement& element, double xi) -> Eigen::RowVector4d {
    return element.half_thickness * detail::curvature_functions(element, xi);
  });
}

Eigen::VectorXd Beam::interpolate(const Eigen::VectorXd& value, const Eigen::VectorXd& slope) const {
  const auto count = static_cast<Eigen::Index>(nodes_.size());
  if (value.size() != count || slope.size() != count) {
    throw InvalidInput(fmt::format("beam: interpolate: {} values and {} slopes; expected {} each, one per node",
                                   value.size(), slope.size(), count));
  }
  if (!value.allFinite() || !slope.allFinite()) throw InvalidInput("beam: interpolate: a value is not finite");
  Eigen::VectorXd q(2 * (count - 1));
  q(Eigen::seq(0, Eigen::last, 2)) = value.tail(count - 1);
  q(Eigen::seq(1, Eigen::last, 2)) = slope.tail(count - 1);
  return q;
}

}  // namespace slipmode::fem
