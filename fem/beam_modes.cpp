#include <slipmode/fem/beam_modes.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/fem/beam_elements.hpp>

#include <fmt/format.h>
#include <numbers>

namespace slipmode::fem {

namespace {

Eigen::VectorXd to_hz(const Eigen::VectorXd& omega) { return omega / (2.0 * std::numbers::pi); }

Eigen::VectorXd frequencies_hz(const BeamOptions& options, detail::BeamEffects effects, Eigen::Index count) {
  const auto [M, K] = detail::assemble_beam(detail::beam_elements(options, effects), options.tip);
  return to_hz(natural_modes(Structure(M, Rayleigh{}, K), count).omega);
}

}  // namespace

BeamShapes beam_shapes(const Beam& beam, const Modes& modes, const Eigen::VectorXd& x) {
  if (modes.shapes.rows() != beam.structure().size()) {
    throw InvalidInput(
        fmt::format("beam shapes: modes of {} degrees of freedom on a beam of {}; give modes of its "
                    "structure",
                    modes.shapes.rows(), beam.structure().size()));
  }
  BeamShapes shapes{.frequency_hz = to_hz(modes.omega), .x = x, .displacement = {}, .slope = {}, .curvature = {}};
  shapes.displacement.resize(x.size(), modes.shapes.cols());
  shapes.slope = shapes.curvature = shapes.displacement;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    shapes.displacement.row(i) = beam.displacement_row(x(i)).transpose() * modes.shapes;
    shapes.slope.row(i) = beam.slope_row(x(i)).transpose() * modes.shapes;
    shapes.curvature.row(i) = beam.curvature_row(x(i)).transpose() * modes.shapes;
  }
  return shapes;
}

std::vector<TheoryEffect> theory_effects(const BeamOptions& options, Eigen::Index count) {
  detail::check_beam_options(options, {.shear = true, .rotary = true});
  if (count < 1) throw InvalidInput(fmt::format("theory effects: {} modes asked; expected at least 1", count));
  const Eigen::VectorXd neither = frequencies_hz(options, {.shear = false, .rotary = false}, count);
  const Eigen::VectorXd shear = frequencies_hz(options, {.shear = true, .rotary = false}, count);
  const Eigen::VectorXd rotary = frequencies_hz(options, {.shear = false, .rotary = true}, count);
  const Eigen::VectorXd both = frequencies_hz(options, {.shear = true, .rotary = true}, count);
  std::vector<TheoryEffect> effects;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double base = neither(i);
    effects.push_back({.euler_bernoulli_hz = base,
                       .shear_hz = shear(i),
                       .rotary_hz = rotary(i),
                       .timoshenko_hz = both(i),
                       .shear_change = (shear(i) - base) / base,
                       .rotary_change = (rotary(i) - base) / base,
                       .timoshenko_change = (both(i) - base) / base});
  }
  return effects;
}

}  // namespace slipmode::fem
