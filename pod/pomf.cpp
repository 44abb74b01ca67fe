#include <slipmode/pod/pomf.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/pod/gram_schmidt.hpp>

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::pod {

namespace {

void check_sensors(const SensorArray& sensors, const Ensemble& displacements) {
  if (!sensors.all(SensorKind::kDisplacement)) {
    throw InvalidInput(
        "modal functions: strain gauges among the sensors; expected displacements only. Convert strains first");
  }
  if (displacements.snapshots.rows() != sensors.size()) {
    throw InvalidInput(fmt::format("modal functions: readings have {} rows; expected {}, one per sensor",
                                   displacements.snapshots.rows(), sensors.size()));
  }
}

ModalFunctions family_functions(const fem::Beam& beam, const SensorArray& sensors, const PomfOptions& options) {
  if (options.functions < 0) {
    throw InvalidInput(fmt::format("modal functions: {} asked; expected 1 to {}, or 0 for one per sensor",
                                   options.functions, sensors.size()));
  }
  const Eigen::Index count = options.functions > 0 ? options.functions : sensors.size();
  return options.family == FitFamily::kPolynomials ? polynomial_functions(beam, count) : natural_functions(beam, count);
}

/// All POMs above rounding: what the fitted ensemble is made of, whatever number is kept.
PodResult all_poms(const Ensemble& displacements, PodOptions options) {
  options.choice = {.modes = 0, .energy = 1.0};
  options.method = PodMethod::kQrSvd;
  return pod(displacements, options);
}

/// Fitted fluctuations are Σ_j ψ_j b_j(t) with uncorrelated b_j of rms σ_j: their mean square along φ_i is
/// Σ_j (φ_iᵀMψ_j)² σ_j².
Eigen::VectorXd shares_of(const Eigen::MatrixXd& Phi, const ModalFit& fit, const PodResult& all, const fem::Matrix& M) {
  const Eigen::Index rank = all.basis.modes();
  const Eigen::MatrixXd scaled = fit.motion(all.basis.vectors) * all.singular_values.head(rank).asDiagonal();
  const Eigen::MatrixXd weighted = fem::multiply(M, scaled);
  const double total = scaled.cwiseProduct(weighted).sum();
  return (Phi.transpose() * weighted).rowwise().squaredNorm() / total;
}

}  // namespace

PomfResult pomfs(const fem::Beam& beam, const SensorArray& sensors, const Ensemble& displacements,
                 const PomfOptions& options) {
  check_sensors(sensors, displacements);
  const ModalFit fit(sensors, family_functions(beam, sensors, options));
  const fem::Matrix& M = beam.structure().M();

  PomfResult result;
  result.discrete = pod(displacements, options.pod);
  const Basis& poms = result.discrete.basis;
  const Eigen::Index k = fit.functions().shapes.cols();
  if (poms.modes() > k) {
    throw InvalidInput(
        fmt::format("modal functions: {} POMs kept, but {} {} carry at most {}; keep fewer POMs or fit more functions",
                    poms.modes(), k, fit.functions().name, k));
  }
  result.continuous = fit.motion(poms.vectors);
  result.basis.vectors = mass_orthonormalise(result.continuous, M, "modal functions").vectors;
  result.basis.mean = fit.motion(poms.mean);
  result.basis.energy = poms.energy;
  result.basis.kind = BasisKind::kPomf;
  result.basis.provenance = fmt::format(
      "proper orthogonal modal functions at {} sensors, fitted by {} {} (condition {:.3g}), Gram-Schmidt in "
      "the mass metric; from {}",
      sensors.size(), k, fit.functions().name, fit.condition(), poms.provenance);
  result.mass_shares = shares_of(result.basis.vectors, fit, all_poms(displacements, options.pod), M);
  result.condition = fit.condition();
  result.misfit = (sensors.readings(result.continuous) - poms.vectors).colwise().norm().maxCoeff();
  return result;
}

}  // namespace slipmode::pod
