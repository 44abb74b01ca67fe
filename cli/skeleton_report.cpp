#include "cli/skeleton_report.hpp"

#include "cli/json_values.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slipmode::cli {

using orbits::OrbitMatch;
using orbits::Skeleton;
using orbits::SkeletonComparison;
using orbits::SkeletonOrbit;

Json skeleton_json(const results::ModelSkeleton& model) {
  Json list = Json::array();
  for (const SkeletonOrbit& member : model.skeleton.orbits) {
    list.push_back({{"period", member.orbit.period},
                    {"length", member.length},
                    {"leading_modulus", member.orbit.leading_modulus},
                    {"stability", orbits::to_string(member.orbit.stability)},
                    {"zero_multipliers", member.orbit.zero_multipliers},
                    {"word", member.orbit.word},
                    {"share", member.share},
                    {"off_attractor", member.off_attractor},
                    {"hits", member.hits},
                    {"residual", member.orbit.residual}});
  }
  Json refused = Json::array();
  for (const orbits::Refusal& refusal : model.skeleton.refusals) {
    refused.push_back(
        merged(fields_json(model.skeleton.candidates[refusal.candidate]), Json{{"reason", refusal.reason}}));
  }
  return {{"title", model.title},
          {"candidates", model.skeleton.candidates.size()},
          {"radius", model.skeleton.radius},
          {"orbits", list},
          {"refused", refused}};
}

std::string skeleton_text(const results::ModelSkeleton& model) {
  TextTable table({"orbit", "period", "length", "|multiplier|", "", "share %", "off", "hits", "mismatch"});
  for (std::size_t k = 0; k < model.skeleton.orbits.size(); ++k) {
    const SkeletonOrbit& member = model.skeleton.orbits[k];
    table.add({std::to_string(k + 1), fmt::format("{:.6g}", member.orbit.period), std::to_string(member.length),
               fixed(member.orbit.leading_modulus, 4), orbits::to_string(member.orbit.stability),
               fixed(100.0 * member.share, 1), fixed(member.off_attractor, 3), std::to_string(member.hits),
               fmt::format("{:.1e}", member.orbit.residual)});
  }
  return fmt::format("{}: {} orbits from {} candidates, {} refused\n{}", model.title, model.skeleton.orbits.size(),
                     model.skeleton.candidates.size(), model.skeleton.refusals.size(), table.str());
}

Json comparison_json(const SkeletonComparison& comparison) {
  Json matched = Json::array();
  for (const OrbitMatch& match : comparison.matched) {
    matched.push_back(merged({{"full", match.full + 1}, {"reduced", match.reduced + 1}}, fields_json(match)));
  }
  return {{"matched", matched},
          {"missed", results::numbers_of(comparison.missed)},
          {"extra", results::numbers_of(comparison.extra)}};
}

std::string comparison_text(const SkeletonComparison& comparison, const Skeleton& full, const Skeleton& reduced) {
  TextTable table(
      {"full", "reduced", "period", "length", "ΔT %", "Δln|multiplier|", "shape %", "share %", "reduced %"});
  for (const OrbitMatch& match : comparison.matched) {
    const SkeletonOrbit& a = full.orbits[match.full];
    const SkeletonOrbit& b = reduced.orbits[match.reduced];
    table.add({std::to_string(match.full + 1), std::to_string(match.reduced + 1), fmt::format("{:.6g}", a.orbit.period),
               std::to_string(a.length), fixed(100.0 * match.period, 3), fixed(match.log_multiplier, 3),
               fixed(100.0 * match.shape, 1), fixed(100.0 * a.share, 1), fixed(100.0 * b.share, 1)});
  }
  const auto list = [](const std::vector<std::size_t>& indices) {
    return indices.empty() ? std::string("none") : fmt::format("{}", fmt::join(results::numbers_of(indices), ", "));
  };
  return fmt::format("{} orbits matched\n{}Missed by the reduced model: {}\nExtra in the reduced model: {}\n",
                     comparison.matched.size(), table.str(), list(comparison.missed), list(comparison.extra));
}

}  // namespace slipmode::cli
