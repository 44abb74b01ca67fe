#include <slipmode/dynamics/step_tables.hpp>

#include <slipmode/core/decompositions.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

/// The largest step spans this many radians of the fastest pair: quadratures below are then exact to rounding.
constexpr double kLongestPhase = 4.0;

/// Values of a function at `targets` from its values at the Chebyshev points of [0, h] (barycentric form).
Eigen::MatrixXd chebyshev_interpolation(const Eigen::VectorXd& points, const Eigen::VectorXd& targets) {
  const auto count = points.size();
  Eigen::MatrixXd L(targets.size(), count);
  for (Eigen::Index i = 0; i < targets.size(); ++i) {
    Eigen::VectorXd row(count);
    for (Eigen::Index j = 0; j < count; ++j) {
      const double weight = (j % 2 == 0 ? 1.0 : -1.0) * (j == 0 || j == count - 1 ? 0.5 : 1.0);
      const double gap = targets(i) - points(j);
      if (gap == 0.0) {
        row.setZero();
        row(j) = 1.0;
        break;
      }
      row(j) = weight / gap;
    }
    L.row(i) = (row / row.sum()).transpose();
  }
  return L;
}

int gauss_points(double phase) { return 16 + static_cast<int>(std::ceil(phase)); }

}  // namespace

StepTables::StepTables(const ModalModel& model)
    : model_(model),
      top_(kLongestPhase / (model.fastest > 0 ? model.fastest : 1.0)),
      loaded_(!model.load.isZero(0.0)) {}

void StepTables::propagate_to(double end, double h, Propagator& out) const {
  const auto& m = model_;
  const auto np = m.np;
  const double length = end * h;
  out.h = length;
  for (auto* e : {&out.e11, &out.e12, &out.e21, &out.e22}) *e = Eigen::VectorXd::Zero(np);
  out.load = Eigen::VectorXd::Zero(2 * np);
  out.response = Eigen::MatrixXd::Zero(2 * np, kNodes * m.contacts);

  const GaussRule gauss = gauss_rule(gauss_points(m.fastest * length));
  const auto points = gauss.node.size();
  Eigen::MatrixXd basis(points, kNodes);  // weight · ℓ_j at the quadrature points
  for (Eigen::Index k = 0; k < points; ++k)
    basis.row(k) = length * gauss.weight(k) * radau().lagrange(end * gauss.node(k)).transpose();

  Eigen::Matrix<double, 4, Eigen::Dynamic> kernel(4, points);
  for (Eigen::Index i = 0; i < m.n; ++i) {
    const Eigen::Matrix2d E = m.exponential(i, length);
    out.e11(i) = E(0, 0);
    out.e12(i) = E(0, 1);
    out.e21(i) = E(1, 0);
    out.e22(i) = E(1, 1);
    for (Eigen::Index k = 0; k < points; ++k) {
      const Eigen::Matrix2d S = m.exponential(i, length * (1.0 - gauss.node(k)));
      kernel.col(k) << S(0, 0), S(0, 1), S(1, 0), S(1, 1);
    }
    const Eigen::Matrix<double, 4, kNodes> moments = kernel * basis;
    for (int c = 0; c < m.contacts; ++c) {
      const double b1 = m.input(i, c), b2 = m.input(np + i, c);
      out.response.row(i).segment<kNodes>(kNodes * c) = moments.row(0) * b1 + moments.row(1) * b2;
      out.response.row(np + i).segment<kNodes>(kNodes * c) = moments.row(2) * b1 + moments.row(3) * b2;
    }
    const Eigen::Vector4d total = moments.rowwise().sum();
    out.load(i) = total(0) * m.load(i) + total(1) * m.load(np + i);
    out.load(np + i) = total(2) * m.load(i) + total(3) * m.load(np + i);
  }
}

void StepTables::make(Propagator& out, int level) const { propagate_to(1.0, step(level), out); }

void StepTables::make(NodeStates& out, int level) const {
  const double h = step(level);
  out.rule = gauss_rule(8 + static_cast<int>(std::ceil(0.75 * model_.fastest * h)));
  out.node.resize(static_cast<std::size_t>(out.rule.node.size()));
  for (std::size_t j = 0; j < out.node.size(); ++j)
    propagate_to(out.rule.node(static_cast<Eigen::Index>(j)), h, out.node[j]);
}

void StepTables::make(Collocation& out, int level) const {
  const auto& m = model_;
  const auto np = m.np;
  const int nc = m.contacts;
  const double h = step(level);
  const auto& node = radau().node;

  out.free = Eigen::MatrixXd::Zero(kNodes, 2 * np * nc);
  for (Eigen::Index i = 0; i < m.n; ++i)
    for (int j = 0; j < kNodes; ++j) {
      const Eigen::Matrix2d E = m.exponential(i, node(j) * h);
      for (int c = 0; c < nc; ++c) {
        const Eigen::RowVector2d row = Eigen::RowVector2d(m.velocity_row(i, c), m.velocity_row(np + i, c)) * E;
        out.free(j, 2 * np * c + i) = row(0);
        out.free(j, 2 * np * c + np + i) = row(1);
      }
    }

  // The kernels g_cᵀ e^{Gs} b_d (and the load's) are smooth scalars: sampled once, then read where quadrature wants
  // them.
  const double phase = m.fastest * h;
  const int samples = 24 + 2 * static_cast<int>(std::ceil(phase));
  Eigen::VectorXd at(samples);
  for (int k = 0; k < samples; ++k) at(k) = h * (1.0 - std::cos(std::numbers::pi * k / (samples - 1))) / 2.0;
  Eigen::MatrixXd kernel_samples = Eigen::MatrixXd::Zero(samples, nc * (nc + 1));  // column c (nc+1) + d, d = nc: load
  for (Eigen::Index i = 0; i < m.n; ++i)
    for (int k = 0; k < samples; ++k) {
      const Eigen::Matrix2d E = m.exponential(i, at(k));
      for (int c = 0; c < nc; ++c) {
        const Eigen::RowVector2d row = Eigen::RowVector2d(m.velocity_row(i, c), m.velocity_row(np + i, c)) * E;
        for (int d = 0; d < nc; ++d)
          kernel_samples(k, c * (nc + 1) + d) += row(0) * m.input(i, d) + row(1) * m.input(np + i, d);
        kernel_samples(k, c * (nc + 1) + nc) += row(0) * m.load(i) + row(1) * m.load(np + i);
      }
    }

  out.load = Eigen::MatrixXd::Zero(kNodes, nc);
  out.kernel = Eigen::MatrixXd::Zero(kNodes * nc, kNodes * nc);
  const GaussRule gauss = gauss_rule(gauss_points(phase));
  for (int j = 0; j < kNodes; ++j) {
    const double length = node(j) * h;
    const Eigen::VectorXd lag = length * (1.0 - gauss.node.array());
    const Eigen::MatrixXd kernel = chebyshev_interpolation(at, lag) * kernel_samples;
    for (Eigen::Index k = 0; k < gauss.node.size(); ++k) {
      const double weight = length * gauss.weight(k);
      const RadauTables::Vector8 basis = radau().lagrange(node(j) * gauss.node(k));
      for (int c = 0; c < nc; ++c) {
        for (int d = 0; d < nc; ++d)
          out.kernel.row(kNodes * c + j).segment<kNodes>(kNodes * d) +=
              weight * kernel(k, c * (nc + 1) + d) * basis.transpose();
        out.load(j, c) += weight * kernel(k, c * (nc + 1) + nc);
      }
    }
  }
  if (nc > 0) out.kernel_norm = out.kernel.cwiseAbs().rowwise().sum().maxCoeff();
  out.kernel_inverse = out.kernel.inverse();
}

void Collocation::free_velocities(const double* x, double* out) const {
  const Eigen::Index nc = load.cols(), columns = free.cols() / std::max<Eigen::Index>(nc, 1);
  for (Eigen::Index c = 0; c < nc; ++c)
    kernels::kernels().node_sums(free.data() + kNodes * columns * c, x, columns, load.col(c).data(), out + kNodes * c);
}

void Collocation::velocities(const double* x, const double* forces, double* out) const {
  free_velocities(x, out);
  Eigen::Map<Eigen::VectorXd>(out, kernel.rows()).noalias() +=
      kernel * Eigen::Map<const Eigen::VectorXd>(forces, kernel.rows());
}

}  // namespace slipmode::dynamics
