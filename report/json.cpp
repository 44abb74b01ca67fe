#include "report/internal/json.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace slipmode::report {
namespace {

constexpr Eigen::Index kShort = 64;

Json stepped(const Eigen::VectorXd& values, double steps) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(high >= low)) low = high = 0.0;
  return stepped_json(values, low, high > low ? (high - low) / steps : 1.0);
}

}  // namespace

Json number_json(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::stod(fmt::format("{:.7g}", value));
}

Json stepped_json(const Eigen::VectorXd& values, double low, double step) {
  Json differences = Json::array();
  std::int64_t last = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) {
      differences.push_back(nullptr);
      continue;
    }
    const std::int64_t now = std::llround((value - low) / step);
    differences.push_back(now - last);
    last = now;
  }
  return {{"low", low}, {"step", step}, {"d", std::move(differences)}};
}

Json list_json(const Eigen::VectorXd& values, Grain grain, bool logarithmic) {
  if (values.size() <= kShort) {
    Json out = Json::array();
    for (const double value : values) out.push_back(number_json(value));
    return out;
  }
  const double steps = grain == Grain::kFine ? 10000.0 : 2000.0;
  if (!logarithmic) return stepped(values, steps);
  Json out = stepped(values.unaryExpr([](double value) { return value > 0.0 ? std::log10(value) : NAN; }), steps);
  out["log"] = true;
  return out;
}

}  // namespace slipmode::report
