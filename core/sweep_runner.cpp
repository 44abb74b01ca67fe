#include <slipmode/core/sweep_runner.hpp>

#include <fmt/format.h>

namespace slipmode::detail {

void check_sweep(std::size_t values, std::size_t segments) {
  if (values == 0) throw InvalidInput("sweep: expected at least one parameter value, found none");
  if (segments >= 1 && segments <= values) return;
  throw InvalidInput(
      fmt::format("sweep: expected between 1 and {} segments (the number of values), found {}", values, segments));
}

void refuse_recalled(std::size_t index, int model, double expected, double found) {
  throw InvalidInput(
      fmt::format("sweep: expected the recalled point {} of model {} to belong to parameter {}, found {}. The journal "
                  "belongs to another sweep",
                  index, model, expected, found));
}

}  // namespace slipmode::detail
