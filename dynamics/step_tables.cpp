#include <slipmode/dynamics/step_tables.hpp>

#include <slipmode/core/decompositions.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

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

/// Of a rule for e^{iφt} times a polynomial of degree 7 over this phase φ ≤ 4: what it is not exact for, Taylor's terms
/// from degree 2 points − 7 on, (φ/4)ⁿ/n! by Chebyshev polynomials, is below rounding.
int gauss_points(double phase) { return 12 + static_cast<int>(std::ceil(phase)); }
/// The same for interpolation of e^{iφt} at Chebyshev's points.
int chebyshev_points(double phase) { return 14 + 2 * static_cast<int>(std::ceil(phase)); }

}  // namespace

StepTables::StepTables(const ModalModel& model)
    : model_(model),
      driven_(model.force_input.cols() > 0 ? std::optional(with_given_forces(model)) : std::nullopt),
      acted_on_(driven_ ? *driven_ : model),
      motion_(model),
      top_(first_step(kLongestPhase / model.pace())),
      loaded_(!model.load.isZero(0.0)) {}

Eigen::MatrixXd StepTables::changes(const Eigen::VectorXd& times) const {
  const auto np = model_.np;
  Eigen::MatrixXd E = motion_.changes(times);
  for (const Eigen::Index i : motion_.others())
    for (Eigen::Index k = 0; k < times.size(); ++k) {
      const Eigen::Matrix2d own = model_.change(i, times(k));
      E.col(k)({i, np + i, 2 * np + i, 3 * np + i}) << own(0, 0), own(0, 1), own(1, 0), own(1, 1);
    }
  return E;
}

Eigen::MatrixXd StepTables::exponentials(const Eigen::VectorXd& times) const {
  Eigen::MatrixXd E = changes(times);
  E.topRows(model_.np).array() += 1.0;
  E.bottomRows(model_.np).array() += 1.0;
  return E;
}

void StepTables::propagate_to(double end, double h, Propagator& out) const {
  const auto& m = acted_on_;
  const auto np = m.np;
  const double length = end * h;
  const GaussRule gauss = gauss_rule(gauss_points(m.fastest * length));
  const auto points = gauss.node.size();
  Eigen::MatrixXd basis(points, kNodes);  // weight · ℓ_j at the quadrature points
  for (Eigen::Index k = 0; k < points; ++k)
    basis.row(k) = length * gauss.weight(k) * radau().lagrange(end * gauss.node(k)).transpose();
  Eigen::VectorXd times(points + 1);
  times << length * (1.0 - gauss.node.array()), length;
  const Eigen::MatrixXd E = exponentials(times), moments = E.leftCols(points) * basis;  // ∫ e^{G(length − t)} ℓ_j dt

  out.h = length;
  const auto e = E.col(points);
  out.e11 = e.head(np);
  out.e12 = e.segment(np, np);
  out.e21 = e.segment(2 * np, np);
  out.e22 = e.tail(np);
  out.response.resize(2 * np, kNodes * m.contacts);
  const auto through = [&](const auto& integrals, const auto& input, auto out_rows) {
    const auto first = input.head(np).asDiagonal(), second = input.tail(np).asDiagonal();
    out_rows.topRows(np) = first * integrals.topRows(np) + second * integrals.middleRows(np, np);
    out_rows.bottomRows(np) = first * integrals.middleRows(2 * np, np) + second * integrals.bottomRows(np);
  };
  for (int c = 0; c < m.contacts; ++c) through(moments, m.input.col(c), out.response.middleCols(kNodes * c, kNodes));
  out.load.resize(2 * np);
  through(moments.rowwise().sum().eval(), m.load, out.load.leftCols(1));
}

void StepTables::make(Propagator& out, int level) const { propagate_to(1.0, step(level), out); }

void StepTables::make(NodeStates& out, int level) const {
  const double h = step(level);
  out.rule = gauss_rule(8 + static_cast<int>(std::ceil(0.75 * model_.fastest * h)));
  out.node.resize(static_cast<std::size_t>(out.rule.node.size()));
  for (std::size_t j = 0; j < out.node.size(); ++j)
    propagate_to(out.rule.node(static_cast<Eigen::Index>(j)), h, out.node[j]);
}

void StepTables::make(const Eigen::MatrixXd& rows, bool change, int level, AtNodes& out) const {
  const auto& m = acted_on_;
  const auto np = m.np;
  const int nc = m.contacts;
  const double h = step(level);
  const auto& node = radau().node;

  out.free.resize(kNodes, 2 * np * nc);
  const Eigen::MatrixXd free = change ? changes(h * node) : exponentials(h * node);
  for (int c = 0; c < nc; ++c) {
    const auto first = rows.col(c).head(np).asDiagonal(), second = rows.col(c).tail(np).asDiagonal();
    const auto upper = free.topRows(2 * np), lower = free.bottomRows(2 * np);
    out.free.middleCols(2 * np * c, np) = (first * upper.topRows(np) + second * lower.topRows(np)).transpose();
    out.free.middleCols(2 * np * c + np, np) =
        (first * upper.bottomRows(np) + second * lower.bottomRows(np)).transpose();
  }

  // The kernels g_cᵀ e^{Gs} b_d (and the load's) are smooth scalars: sampled once, then read where quadrature wants
  // them.
  const double phase = m.fastest * h;
  const int samples = chebyshev_points(phase);
  Eigen::VectorXd at(samples);
  for (int k = 0; k < samples; ++k) at(k) = h * (1.0 - std::cos(std::numbers::pi * k / (samples - 1))) / 2.0;
  Eigen::MatrixXd ends(4 * np, nc * (nc + 1));  // entries of e^{Gs} → column c (nc+1) + d, d = nc: load
  for (int c = 0; c < nc; ++c)
    for (int d = 0; d <= nc; ++d) {
      const Eigen::VectorXd input = d < nc ? m.input.col(d) : m.load;
      ends.col(c * (nc + 1) + d) << rows.col(c).head(np).replicate(2, 1).cwiseProduct(input),
          rows.col(c).tail(np).replicate(2, 1).cwiseProduct(input);
    }
  const Eigen::MatrixXd kernel_samples = exponentials(at).transpose() * ends;

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
}

void StepTables::make(Collocation& out, int level) const {
  make(acted_on_.velocity_row, false, level, static_cast<AtNodes&>(out));
  const int own = kNodes * model_.contacts;
  out.own_kernel = out.kernel.topLeftCorner(own, own);
  if (own > 0) out.kernel_norm = out.own_kernel.cwiseAbs().rowwise().sum().maxCoeff();
  out.kernel_inverse = out.own_kernel.inverse();
}

void AtNodes::without_forces(const double* x, Eigen::Index contacts, double* out) const {
  const Eigen::Index columns = free.cols() / std::max<Eigen::Index>(load.cols(), 1);
  for (Eigen::Index c = 0; c < contacts; ++c)
    kernels::kernels().node_sums(free.data() + kNodes * columns * c, x, columns, load.col(c).data(), out + kNodes * c);
}

void Collocation::velocities(const double* x, const double* forces, double* out) const {
  without_forces(x, load.cols(), out);
  Eigen::Map<Eigen::VectorXd>(out, kernel.rows()).noalias() +=
      kernel * Eigen::Map<const Eigen::VectorXd>(forces, kernel.rows());
}

}  // namespace slipmode::dynamics
