#include <slipmode/core/errors.hpp>
#include <slipmode/fem/beam_elements.hpp>

#include <fmt/format.h>
#include <cmath>
#include <string>

namespace slipmode::fem::detail {

namespace {

enum class Sign { kPositive, kNonNegative, kAny };

void check(const std::string& where, const char* key, double value, const char* unit, Sign sign) {
  const bool in_range = sign == Sign::kAny || (sign == Sign::kPositive ? value > 0.0 : value >= 0.0);
  if (in_range && std::isfinite(value)) return;
  const char* range = sign == Sign::kPositive ? " > 0" : sign == Sign::kNonNegative ? " >= 0" : "";
  throw InvalidInput(fmt::format("beam: {}: {} = {}; expected a finite value{}{}{}", where, key, value, range,
                                 *unit ? " " : "", unit));
}

void check_span(const BeamSpan& span, std::size_t number, BeamEffects effects) {
  const std::string where = fmt::format("span {}", number);
  check(where, "length", span.length, "m", Sign::kPositive);
  check(where, "width", span.width, "m", Sign::kPositive);
  check(where, "thickness", span.thickness, "m", Sign::kPositive);
  check(where, "youngs_modulus", span.youngs_modulus, "Pa", Sign::kPositive);
  check(where, "density", span.density, "kg/m^3", Sign::kPositive);
  if (span.elements < 1) {
    throw InvalidInput(fmt::format("beam: {}: elements = {}; expected at least 1", where, span.elements));
  }
  if (!effects.shear) return;
  if (!(span.poisson_ratio > -1.0 && span.poisson_ratio <= 0.5)) {
    throw InvalidInput(
        fmt::format("beam: {}: poisson_ratio = {}; expected -1 < ratio <= 0.5", where, span.poisson_ratio));
  }
  check(where, "shear_coefficient", span.shear_coefficient, "", Sign::kPositive);
}

void check_tip(const TipBody& tip) {
  check("tip", "mass", tip.mass, "kg", Sign::kNonNegative);
  check("tip", "inertia", tip.inertia, "kg m^2", Sign::kNonNegative);
  check("tip", "offset", tip.offset, "m", Sign::kAny);
  check("tip", "extension", tip.extension, "m", Sign::kNonNegative);
}

}  // namespace

void check_beam_options(const BeamOptions& options, BeamEffects effects) {
  if (options.spans.empty()) throw InvalidInput("beam: no spans; expected at least one");
  for (std::size_t i = 0; i < options.spans.size(); ++i) check_span(options.spans[i], i + 1, effects);
  check_tip(options.tip);
}

}  // namespace slipmode::fem::detail
