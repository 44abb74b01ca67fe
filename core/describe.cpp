#include <slipmode/core/describe.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode {

std::string describe(const NumericalFailure& failure) {
  constexpr Eigen::Index kShown = 20;
  std::string text = fmt::format("{}\n  time {:.17g}", failure.what(), failure.time);
  if (!std::isnan(failure.residual)) text += fmt::format(", residual {:.6g}", failure.residual);
  text += "\n  state";
  for (Eigen::Index i = 0; i < std::min(failure.state.size(), kShown); ++i) {
    text += fmt::format(" {:.17g}", failure.state[i]);
  }
  if (failure.state.size() == 0) text += " not known";
  if (failure.state.size() > kShown) text += fmt::format(" ... ({} values)", failure.state.size());
  return text;
}

}  // namespace slipmode
