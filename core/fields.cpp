#include <slipmode/core/fields.hpp>

#include <fmt/format.h>
#include <cstdint>

namespace slipmode {

std::string integer_text(const Limits& limits) {
  const auto low = static_cast<std::int64_t>(limits.low);
  if (limits.high >= std::numeric_limits<int>::max()) return fmt::format("an integer >= {}", low);
  return fmt::format("an integer from {} to {}", low, static_cast<std::int64_t>(limits.high));
}

}  // namespace slipmode
