#include <slipmode/fem/beam_elements.hpp>

#include <array>
#include <cmath>

namespace slipmode::fem::detail {

namespace {

using Triplet = Eigen::Triplet<double>;

struct GaussPoint {
  double xi, weight;  // on [0, 1]
};

// Four points integrate degree 7; the mass needs 6.
std::array<GaussPoint, 4> gauss_points() {
  const double root = 2.0 / 7.0 * std::sqrt(6.0 / 5.0);
  const double inner = std::sqrt(3.0 / 7.0 - root), outer = std::sqrt(3.0 / 7.0 + root);
  const double heavy = (18.0 + std::sqrt(30.0)) / 72.0, light = (18.0 - std::sqrt(30.0)) / 72.0;
  return {{{(1.0 - outer) / 2.0, light},
           {(1.0 - inner) / 2.0, heavy},
           {(1.0 + inner) / 2.0, heavy},
           {(1.0 + outer) / 2.0, light}}};
}

void add_block(std::vector<Triplet>& triplets, const Eigen::Ref<const Eigen::MatrixXd>& block, int first_dof) {
  for (int row = 0; row < block.rows(); ++row) {
    for (int col = 0; col < block.cols(); ++col) {
      if (first_dof + row >= 0 && first_dof + col >= 0) {
        triplets.emplace_back(first_dof + row, first_dof + col, block(row, col));
      }
    }
  }
}

SparseMatrix from_triplets(int n, const std::vector<Triplet>& triplets) {
  SparseMatrix A(n, n);
  A.setFromTriplets(triplets.begin(), triplets.end());
  return A;
}

}  // namespace

BeamEffects effects_of(BeamTheory theory) {
  const bool both = theory == BeamTheory::kTimoshenko;
  return {.shear = both, .rotary = both};
}

Eigen::RowVector4d displacement_functions(const BeamElement& element, double xi) {
  const double phi = element.shear_ratio(), l = element.length, rest = 1.0 - xi, bubble = xi * rest;
  Eigen::RowVector4d N;
  N << rest * rest * (1.0 + 2.0 * xi) + phi * rest, l * bubble * (rest + phi / 2.0),
      xi * xi * (1.0 + 2.0 * rest) + phi * xi, -l * bubble * (xi + phi / 2.0);
  return N / (1.0 + phi);
}

Eigen::RowVector4d slope_functions(const BeamElement& element, double xi) {
  const double phi = element.shear_ratio(), l = element.length, bubble = xi * (1.0 - xi);
  Eigen::RowVector4d N;
  N << -(6.0 * bubble + phi) / l, 1.0 + xi * (3.0 * xi - 4.0) + phi / 2.0 * (1.0 - 2.0 * xi), (6.0 * bubble + phi) / l,
      xi * (3.0 * xi - 2.0) - phi / 2.0 * (1.0 - 2.0 * xi);
  return N / (1.0 + phi);
}

Eigen::RowVector4d rotation_functions(const BeamElement& element, double xi) {
  const double phi = element.shear_ratio(), l = element.length, bubble = xi * (1.0 - xi);
  Eigen::RowVector4d N;
  N << -6.0 * bubble / l, 1.0 + xi * (3.0 * xi - 4.0) + phi * (1.0 - xi), 6.0 * bubble / l,
      xi * (3.0 * xi - 2.0) + phi * xi;
  return N / (1.0 + phi);
}

Eigen::RowVector4d curvature_functions(const BeamElement& element, double xi) {
  const double phi = element.shear_ratio(), l = element.length, tilt = 6.0 * (2.0 * xi - 1.0) / l;
  Eigen::RowVector4d N;
  N << tilt / l, (6.0 * xi - 4.0 - phi) / l, -tilt / l, (6.0 * xi - 2.0 + phi) / l;
  return N / (1.0 + phi);
}

Eigen::Matrix4d element_stiffness(const BeamElement& element) {
  const double phi = element.shear_ratio(), l = element.length;
  const double near = (4.0 + phi) * l * l, far = (2.0 - phi) * l * l;
  Eigen::Matrix4d K;
  K << 12.0, 6.0 * l, -12.0, 6.0 * l,   //
      6.0 * l, near, -6.0 * l, far,     //
      -12.0, -6.0 * l, 12.0, -6.0 * l,  //
      6.0 * l, far, -6.0 * l, near;
  return element.bending / (l * l * l * (1.0 + phi)) * K;
}

Eigen::Matrix4d element_mass(const BeamElement& element) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
  for (const auto& [xi, weight] : gauss_points()) {
    const Eigen::RowVector4d y = displacement_functions(element, xi), theta = rotation_functions(element, xi);
    M += weight * element.length * (element.mass * y.transpose() * y + element.rotary * theta.transpose() * theta);
  }
  return (M + M.transpose()) / 2.0;
}

Eigen::Matrix2d tip_mass(const TipBody& tip) {
  const double moment = tip.mass * tip.offset;
  Eigen::Matrix2d M;
  M << tip.mass, moment, moment, tip.inertia + moment * tip.offset;
  return M;
}

std::vector<BeamElement> beam_elements(const BeamOptions& options, BeamEffects effects) {
  std::vector<BeamElement> elements;
  for (const BeamSpan& span : options.spans) {
    const double area = span.width * span.thickness;
    const double second_moment = area * span.thickness * span.thickness / 12.0;
    BeamElement element;
    element.length = span.length / span.elements;
    element.bending = span.youngs_modulus * second_moment;
    element.mass = span.density * area;
    element.half_thickness = span.thickness / 2.0;
    const double shear_modulus = span.youngs_modulus / (2.0 * (1.0 + span.poisson_ratio));
    if (effects.shear) element.shear = span.shear_coefficient * shear_modulus * area;
    if (effects.rotary) element.rotary = span.density * second_moment;
    elements.insert(elements.end(), static_cast<std::size_t>(span.elements), element);
  }
  return elements;
}

MassAndStiffness assemble_beam(const std::vector<BeamElement>& elements, const TipBody& tip) {
  std::vector<Triplet> mass, stiffness;
  mass.reserve(16 * elements.size() + 4);
  stiffness.reserve(16 * elements.size());
  int first_dof = -2;  // the clamped node's, struck out
  for (const BeamElement& element : elements) {
    add_block(mass, element_mass(element), first_dof);
    add_block(stiffness, element_stiffness(element), first_dof);
    first_dof += 2;
  }
  add_block(mass, tip_mass(tip), first_dof);
  const int n = first_dof + 2;
  return {from_triplets(n, mass), from_triplets(n, stiffness)};
}

}  // namespace slipmode::fem::detail
