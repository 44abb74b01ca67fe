#include "fem/internal/beam_damping.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/fem/modes.hpp>

#include <fmt/format.h>
#include <cmath>
#include <numbers>
#include <utility>

namespace slipmode::fem::detail {

namespace {

void check_non_negative(const char* what, double value) {
  if (value >= 0.0 && std::isfinite(value)) return;
  throw InvalidInput(fmt::format("beam: damping: {} = {}; expected a finite value >= 0", what, value));
}

double angular(const RatioAt& point) {
  check_non_negative("ratio", point.ratio);
  if (!(point.frequency_hz > 0.0) || !std::isfinite(point.frequency_hz)) {
    throw InvalidInput(
        fmt::format("beam: damping: frequency = {} Hz; expected a finite value > 0", point.frequency_hz));
  }
  return 2.0 * std::numbers::pi * point.frequency_hz;
}

// a + b ω² = 2 ζ ω at both points.
Rayleigh through_two(const RatioAt& first, const RatioAt& second) {
  const double w1 = angular(first), w2 = angular(second);
  if (w1 == w2) {
    throw InvalidInput(
        fmt::format("beam: damping: two ratios at the same frequency, {} Hz; give two frequencies or one "
                    "ratio",
                    first.frequency_hz));
  }
  const double spread = (w2 - w1) * (w2 + w1);
  return {.mass = 2.0 * w1 * w2 * (first.ratio * w2 - second.ratio * w1) / spread,
          .stiffness = 2.0 * (second.ratio * w2 - first.ratio * w1) / spread};
}

// A negative b makes the damping of high modes negative, a negative a that of modes below √(−a/b).
void check_semi_definite(const Rayleigh& fit, const MassAndStiffness& matrices) {
  const auto refuse = [&fit](const char* modes) {
    throw InvalidInput(
        fmt::format("beam: damping: the two ratios need C = aM + bK with a = {:.6g} 1/s, b = {:.6g} s, "
                    "which damps {} negatively; bring the ratios closer together or give a ratio for "
                    "each mode",
                    fit.mass, fit.stiffness, modes));
  };
  if (fit.stiffness < 0.0) refuse("high modes");
  if (fit.mass >= 0.0) return;
  const double omega = natural_modes(Structure(matrices.M, Rayleigh{}, matrices.K), 1).omega(0);
  if (fit.mass + fit.stiffness * omega * omega < 0.0) refuse("the first mode");
}

Rayleigh coefficients(const ProportionalRatios& ratios, const MassAndStiffness& matrices) {
  if (ratios.at.size() == 1) return {.mass = 0.0, .stiffness = 2.0 * ratios.at[0].ratio / angular(ratios.at[0])};
  if (ratios.at.size() != 2) {
    throw InvalidInput(fmt::format(
        "beam: damping: ratios at {} frequencies; expected one (C = bK) or two (C = aM + bK)", ratios.at.size()));
  }
  const Rayleigh fit = through_two(ratios.at[0], ratios.at[1]);
  check_semi_definite(fit, matrices);
  return fit;
}

Eigen::MatrixXd modal_damping(const MassAndStiffness& matrices, const ModalRatios& damping) {
  if (damping.ratios.empty()) throw InvalidInput("beam: damping: no modal ratios; expected at least one");
  for (const double ratio : damping.ratios) check_non_negative("modal ratio", ratio);
  const Modes modes = natural_modes(Structure(matrices.M, Rayleigh{}, matrices.K));
  Eigen::VectorXd root(modes.omega.size());
  for (Eigen::Index i = 0; i < root.size(); ++i) {
    const auto mode = std::min(static_cast<std::size_t>(i), damping.ratios.size() - 1);
    root(i) = std::sqrt(2.0 * damping.ratios[mode] * modes.omega(i));
  }
  const Eigen::MatrixXd half = matrices.M * modes.shapes * root.asDiagonal();
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(half.rows(), half.rows());
  C.selfadjointView<Eigen::Lower>().rankUpdate(half);
  return C.selfadjointView<Eigen::Lower>();
}

}  // namespace

Structure damped_beam(MassAndStiffness matrices, const BeamDamping& damping, std::vector<std::string> dof_names) {
  if (const auto* modal = std::get_if<ModalRatios>(&damping)) {
    Eigen::MatrixXd C = modal_damping(matrices, *modal);
    return {std::move(matrices.M), std::move(C), std::move(matrices.K), std::move(dof_names), "SI"};
  }
  Rayleigh rayleigh;
  if (const auto* ratios = std::get_if<ProportionalRatios>(&damping)) {
    rayleigh = coefficients(*ratios, matrices);
  } else {
    rayleigh = std::get<Rayleigh>(damping);
    check_non_negative("mass coefficient", rayleigh.mass);
    check_non_negative("stiffness coefficient", rayleigh.stiffness);
  }
  return {std::move(matrices.M), rayleigh, std::move(matrices.K), std::move(dof_names), "SI"};
}

}  // namespace slipmode::fem::detail
