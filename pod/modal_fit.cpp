#include <slipmode/pod/modal_fit.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/modes.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <utility>

namespace slipmode::pod {

namespace {

constexpr double kSingular = 1e10;  // condition above which fewer than six digits of an amplitude are left

void check_count(const fem::Beam& beam, Eigen::Index count, const char* name) {
  const Eigen::Index n = beam.structure().size();
  if (count >= 1 && count <= n) return;
  throw InvalidInput(fmt::format("modal functions: {} {} asked of a beam of {} degrees of freedom; expected 1 to {}",
                                 count, name, n, n));
}

/// 1 for sensors of one kind; else one over the largest reading any function gives on a sensor of that kind.
Eigen::VectorXd row_weights(const SensorArray& sensors, const Eigen::MatrixXd& F) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(F.rows());
  if (sensors.all(SensorKind::kStrain) || sensors.all(SensorKind::kDisplacement)) return weights;
  for (const SensorKind kind : {SensorKind::kStrain, SensorKind::kDisplacement}) {
    double largest = 0.0;
    for (Eigen::Index i = 0; i < F.rows(); ++i) {
      if (sensors.sensors()[static_cast<std::size_t>(i)].kind == kind) {
        largest = std::max(largest, F.row(i).cwiseAbs().maxCoeff());
      }
    }
    for (Eigen::Index i = 0; i < F.rows() && largest > 0.0; ++i) {
      if (sensors.sensors()[static_cast<std::size_t>(i)].kind == kind) weights[i] = 1.0 / largest;
    }
  }
  return weights;
}

}  // namespace

ModalFunctions natural_functions(const fem::Beam& beam, Eigen::Index count) {
  check_count(beam, count, "natural modes");
  return {fem::natural_modes(beam.structure(), count).shapes, "natural modes"};
}

ModalFunctions polynomial_functions(const fem::Beam& beam, Eigen::Index count) {
  check_count(beam, count, "powers of x");
  const Eigen::Map<const Eigen::ArrayXd> x(beam.nodes().data(), static_cast<Eigen::Index>(beam.nodes().size()));
  const Eigen::ArrayXd s = x / beam.length();
  ModalFunctions functions{Eigen::MatrixXd(beam.structure().size(), count), "powers of x from the second"};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double power = static_cast<double>(i + 2);
    functions.shapes.col(i) = beam.interpolate(s.pow(power), power / beam.length() * s.pow(power - 1.0));
  }
  return functions;
}

ModalFit::ModalFit(const SensorArray& sensors, ModalFunctions functions) : functions_(std::move(functions)) {
  const Eigen::Index k = functions_.shapes.cols();
  if (functions_.shapes.rows() != sensors.rows().cols() || k < 1 || !functions_.shapes.allFinite()) {
    throw InvalidInput(
        fmt::format("modal fit: functions are {} x {}; expected {} rows, one per degree of freedom of "
                    "the sensors' beam, and at least one column of finite values",
                    functions_.shapes.rows(), k, sensors.rows().cols()));
  }
  if (k > sensors.size()) {
    throw InvalidInput(
        fmt::format("modal fit: {} {}, more modal functions than {} sensors can tell apart; use at most {}, or add "
                    "sensors",
                    k, functions_.name, sensors.size(), sensors.size()));
  }
  const Eigen::MatrixXd F = sensors.readings(functions_.shapes);
  const Eigen::VectorXd weights = row_weights(sensors, F);
  const Eigen::MatrixXd weighted = weights.asDiagonal() * F;
  const Eigen::VectorXd lengths = weighted.colwise().norm();
  for (Eigen::Index j = 0; j < k; ++j) {
    if (lengths[j] > 0.0) continue;
    throw InvalidInput(
        fmt::format("modal fit: singular fit: no sensor reads anything of function {} (from 1) of the "
                    "{}; move or add sensors, or use fewer functions",
                    j + 1, functions_.name));
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(weighted * lengths.cwiseInverse().asDiagonal(),
                                              Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& sigma = svd.singularValues();
  condition_ = sigma[k - 1] > 0.0 ? sigma[0] / sigma[k - 1] : std::numeric_limits<double>::infinity();
  if (!(condition_ <= kSingular)) {
    throw InvalidInput(
        fmt::format("modal fit: singular fit of {} {} to {} sensors: condition number {:.3g}, at most "
                    "{:.0e} allowed; spread the sensors, add some, or use fewer functions",
                    k, functions_.name, sensors.size(), condition_, kSingular));
  }
  inverse_ = lengths.cwiseInverse().asDiagonal() * svd.matrixV() * sigma.cwiseInverse().asDiagonal() *
             svd.matrixU().transpose() * weights.asDiagonal();
}

Eigen::MatrixXd ModalFit::amplitudes(const Eigen::MatrixXd& readings) const {
  if (readings.rows() != inverse_.cols()) {
    throw InvalidInput(
        fmt::format("modal fit: readings have {} rows; expected {}, one per sensor", readings.rows(), inverse_.cols()));
  }
  return inverse_ * readings;
}

Eigen::MatrixXd ModalFit::motion(const Eigen::MatrixXd& readings) const {
  return functions_.shapes * amplitudes(readings);
}

Eigen::MatrixXd ModalFit::transfer(const SensorArray& at) const { return at.readings(functions_.shapes) * inverse_; }

Ensemble converted(const Ensemble& readings, const ModalFit& fit, const SensorArray& at) {
  return {at.readings(fit.functions().shapes) * fit.amplitudes(readings.snapshots), readings.run_begin};
}

}  // namespace slipmode::pod
