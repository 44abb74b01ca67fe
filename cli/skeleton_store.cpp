#include "cli/skeleton_store.hpp"

#include "cli/text_table.hpp"
#include "results/orbit_records.hpp"
#include "results/table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slipmode::cli {
namespace {

using orbits::OrbitMatch;
using orbits::Skeleton;
using orbits::SkeletonComparison;
using orbits::SkeletonOrbit;

/// One number per orbit.
template <class Number>
std::vector<double> column(const Skeleton& skeleton, const Number& number) {
  std::vector<double> values;
  for (const SkeletonOrbit& member : skeleton.orbits) values.push_back(static_cast<double>(number(member)));
  return values;
}

template <class Number>
std::vector<double> column(const SkeletonComparison& comparison, const Number& number) {
  std::vector<double> values;
  for (const OrbitMatch& match : comparison.matched) values.push_back(static_cast<double>(number(match)));
  return values;
}

/// Orbits are numbered from 1 for people.
std::vector<std::int64_t> numbers_of(const std::vector<std::size_t>& indices) {
  std::vector<std::int64_t> numbers;
  for (const std::size_t index : indices) numbers.push_back(static_cast<std::int64_t>(index) + 1);
  return numbers;
}

results::Table orbit_table(const Skeleton& skeleton, const results::Units& units) {
  std::vector<std::string> word, stability;
  for (const SkeletonOrbit& member : skeleton.orbits) {
    word.push_back(member.orbit.word);
    stability.push_back(orbits::to_string(member.orbit.stability));
  }
  return {
      "one row per orbit, by period",
      {{"period", {units.time, "period"}, column(skeleton, [](const auto& m) { return m.orbit.period; })},
       {"length", {"", "passages of the section per period"}, column(skeleton, [](const auto& m) { return m.length; })},
       {"leading_modulus",
        {"1", "largest |multiplier| but the trivial one"},
        column(skeleton, [](const auto& m) { return m.orbit.leading_modulus; })},
       {"stability", {"", "stable, unstable or marginal"}, stability},
       {"share",
        {"1",
         fmt::format("share of the attractor within {:g} of the orbit, in the attractor's metric", skeleton.radius)},
        column(skeleton, [](const auto& m) { return m.share; })},
       {"off_attractor",
        {"1", "largest distance of a passage to the nearest of the attractor, in its metric"},
        column(skeleton, [](const auto& m) { return m.off_attractor; })},
       {"hits", {"", "candidates that led here"}, column(skeleton, [](const auto& m) { return m.hits; })},
       {"residual",
        {"1", "relative mismatch after the period"},
        column(skeleton, [](const auto& m) { return m.orbit.residual; })},
       {"word", {"", "sequence of regimes"}, word}}};
}

results::Table refusal_table(const Skeleton& skeleton, const results::Units& units) {
  std::vector<double> length, period, distance;
  std::vector<std::string> origin, reason;
  for (const orbits::Refusal& refusal : skeleton.refusals) {
    const orbits::Candidate& candidate = skeleton.candidates[refusal.candidate];
    length.push_back(static_cast<double>(candidate.length));
    period.push_back(candidate.period);
    distance.push_back(candidate.distance);
    origin.push_back(candidate.origin);
    reason.push_back(refusal.reason);
  }
  return {"candidates that became no orbit",
          {{"length", {"", "passages per period, as guessed"}, length},
           {"period", {units.time, "period, as guessed"}, period},
           {"distance", {"1", "of the close return, in the attractor's metric"}, distance},
           {"origin", {"", "where the candidate is from"}, origin},
           {"reason", {"", "why it was refused"}, reason}}};
}

}  // namespace

void store_skeleton(results::StoreWriter& writer, const std::string& name, const ModelSkeleton& model,
                    const results::Units& units) {
  const std::string group = fmt::format("{}/{}", kSkeletonGroup, name);
  writer.describe_group(group, model.title);
  writer.write(group + "/title", model.title, {"", "which model"});
  writer.write(group + "/candidates", static_cast<std::int64_t>(model.skeleton.candidates.size()),
               {"", "close returns and transferred orbits tried"});
  writer.write_columns(group + "/portrait", model.portrait,
                       {units.length, "displacement and velocity of the first contact along the attractor"});
  results::save(writer, group + "/orbits", orbit_table(model.skeleton, units));
  results::save(writer, group + "/refusals", refusal_table(model.skeleton, units));
  for (std::size_t k = 0; k < model.skeleton.orbits.size(); ++k) {
    const SkeletonOrbit& member = model.skeleton.orbits[k];
    const std::string own = fmt::format("{}/orbit_{:03}", group, k + 1);
    results::save(writer, own, member.orbit);
    writer.write_columns(own + "/passages", member.points, {units.length, "(q; q') at the section, full model"});
    writer.write_columns(own + "/path", member.path,
                         {units.length, "(q; q') at equal parts of each interval between passages, full model"});
    writer.write(own + "/intervals", member.intervals, {units.time, "from each passage to the next"});
  }
}

void store_comparison(results::StoreWriter& writer, const SkeletonComparison& comparison) {
  const std::string group = fmt::format("{}/comparison", kSkeletonGroup);
  writer.describe_group(group, "orbits of the full and of the reduced model; differences are reduced less full");
  const results::Table matched{
      "orbits that both have",
      {{"full",
        {"", "number of the full model's orbit, from 1"},
        column(comparison, [](const auto& m) { return m.full + 1; })},
       {"reduced",
        {"", "number of the reduced model's orbit, from 1"},
        column(comparison, [](const auto& m) { return m.reduced + 1; })},
       {"period", {"1", "difference of periods, relative"}, column(comparison, [](const auto& m) { return m.period; })},
       {"log_multiplier",
        {"1", "difference of ln |leading multiplier|"},
        column(comparison, [](const auto& m) { return m.log_multiplier; })},
       {"shape",
        {"1", "root mean square distance of the paths, relative to the full orbit's size"},
        column(comparison, [](const auto& m) { return m.shape; })},
       {"share", {"1", "difference of shares"}, column(comparison, [](const auto& m) { return m.share; })}}};
  results::save(writer, group + "/matched", matched);
  writer.write(group + "/missed", numbers_of(comparison.missed), {"", "orbits of the full model without a partner"});
  writer.write(group + "/extra", numbers_of(comparison.extra), {"", "orbits of the reduced model without a partner"});
}

Json skeleton_json(const ModelSkeleton& model) {
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
    const orbits::Candidate& candidate = model.skeleton.candidates[refusal.candidate];
    refused.push_back({{"origin", candidate.origin},
                       {"length", candidate.length},
                       {"period", candidate.period},
                       {"distance", candidate.distance},
                       {"reason", refusal.reason}});
  }
  return {{"title", model.title},
          {"candidates", model.skeleton.candidates.size()},
          {"radius", model.skeleton.radius},
          {"orbits", list},
          {"refused", refused}};
}

std::string skeleton_text(const ModelSkeleton& model) {
  TextTable table({"orbit", "period", "length", "|multiplier|", "", "share %", "off", "hits", "mismatch"});
  for (std::size_t k = 0; k < model.skeleton.orbits.size(); ++k) {
    const SkeletonOrbit& member = model.skeleton.orbits[k];
    table.add({std::to_string(k + 1), fixed(member.orbit.period, 5), std::to_string(member.length),
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
    matched.push_back({{"full", match.full + 1},
                       {"reduced", match.reduced + 1},
                       {"period", match.period},
                       {"log_multiplier", match.log_multiplier},
                       {"shape", match.shape},
                       {"share", match.share}});
  }
  return {{"matched", matched}, {"missed", numbers_of(comparison.missed)}, {"extra", numbers_of(comparison.extra)}};
}

std::string comparison_text(const SkeletonComparison& comparison, const Skeleton& full, const Skeleton& reduced) {
  TextTable table(
      {"full", "reduced", "period", "length", "ΔT %", "Δln|multiplier|", "shape %", "share %", "reduced %"});
  for (const OrbitMatch& match : comparison.matched) {
    const SkeletonOrbit& a = full.orbits[match.full];
    const SkeletonOrbit& b = reduced.orbits[match.reduced];
    table.add({std::to_string(match.full + 1), std::to_string(match.reduced + 1), fixed(a.orbit.period, 4),
               std::to_string(a.length), fixed(100.0 * match.period, 3), fixed(match.log_multiplier, 3),
               fixed(100.0 * match.shape, 1), fixed(100.0 * a.share, 1), fixed(100.0 * b.share, 1)});
  }
  const auto list = [](const std::vector<std::size_t>& indices) {
    return indices.empty() ? std::string("none") : fmt::format("{}", fmt::join(numbers_of(indices), ", "));
  };
  return fmt::format("{} orbits matched\n{}Missed by the reduced model: {}\nExtra in the reduced model: {}\n",
                     comparison.matched.size(), table.str(), list(comparison.missed), list(comparison.extra));
}

}  // namespace slipmode::cli
