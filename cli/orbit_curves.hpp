#pragma once

#include <slipmode/studies/special_curves.hpp>
#include "cli/session.hpp"

#include <memory>
#include <string>

namespace slipmode::cli {

/// KEY=FROM:TO, a range followed without steps.
struct OrbitRange {
  std::string key;
  double from = 0.0, to = 0.0;
};
/// @param option   that was given, e.g. "--over" @param example  of what it takes
/// @throws InvalidInput  for a text without key or range, and one without length
[[nodiscard]] OrbitRange parse_range(const std::string& option, const std::string& text, const std::string& example);

/// Curves of special points, told and stored; exit 3 where there is none, or one was lost on its way, 130 where it was
/// interrupted.
/// @param model    over both keys, at their values where the curves begin
/// @param command  for provenance @param output  result file
[[nodiscard]] Report curves_report(const studies::Family& model,
                                   const std::shared_ptr<const studies::SpecialCurves>& found,
                                   const studies::ContinuationRequest& request, const studies::CurveRequest& curve,
                                   const std::string& command, const std::string& output);

}  // namespace slipmode::cli
