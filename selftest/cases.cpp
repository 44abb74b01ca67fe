#include "selftest/cases.hpp"

#include <cmath>
#include <exception>
#include <limits>

namespace slipmode::selftest {

std::vector<ExtremeCase> extreme_cases() {
  std::vector<ExtremeCase> all;
  for (const auto& group : {size_cases(), friction_cases(), event_cases(), reduction_cases()})
    all.insert(all.end(), group.begin(), group.end());
  return all;
}

ExtremeResult run_case(const ExtremeCase& extreme) {
  ExtremeResult result{.name = extreme.name, .law = extreme.law, .note = {}, .limit = extreme.limit};
  try {
    result.measured = extreme.measure();
  } catch (const std::exception& error) {
    result.measured = std::numeric_limits<double>::infinity();
    result.note = error.what();
  }
  result.holds = result.measured <= extreme.limit;
  return result;
}

}  // namespace slipmode::selftest
