#include <slipmode/results/skeleton_store.hpp>

#include <slipmode/results/orbit_records.hpp>
#include <slipmode/results/table.hpp>

#include "results/internal/field_record.hpp"

#include <fmt/format.h>

namespace slipmode::results {
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

Table orbit_table(const Skeleton& skeleton, const Units& units) {
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

Table refusal_table(const Skeleton& skeleton) {
  std::vector<std::string> reason;
  for (const orbits::Refusal& refusal : skeleton.refusals) reason.push_back(refusal.reason);
  const auto candidate = [&](const orbits::Refusal& refusal) -> const auto& {
    return skeleton.candidates[refusal.candidate];
  };
  return {"candidates that became no orbit",
          joined({columns_of(skeleton.refusals, candidate), {{"reason", {"", "why it was refused"}, reason}}})};
}

}  // namespace

std::vector<std::int64_t> numbers_of(const std::vector<std::size_t>& indices) {
  std::vector<std::int64_t> numbers;
  for (const std::size_t index : indices) numbers.push_back(static_cast<std::int64_t>(index) + 1);
  return numbers;
}

void store_skeleton(StoreWriter& writer, const std::string& name, const ModelSkeleton& model, const Units& units) {
  const std::string group = fmt::format("{}/{}", kSkeletonGroup, name);
  writer.describe_group(group, model.title);
  writer.write(group + "/title", model.title, {"", "which model"});
  writer.write(group + "/candidates", static_cast<std::int64_t>(model.skeleton.candidates.size()),
               {"", "close returns and transferred orbits tried"});
  writer.write_columns(group + "/portrait", model.portrait,
                       {units.length, "displacement and velocity of the first contact along the attractor"});
  save(writer, group + "/orbits", orbit_table(model.skeleton, units));
  save(writer, group + "/refusals", refusal_table(model.skeleton));
  for (std::size_t k = 0; k < model.skeleton.orbits.size(); ++k) {
    const SkeletonOrbit& member = model.skeleton.orbits[k];
    const std::string own = fmt::format("{}/orbit_{:03}", group, k + 1);
    save(writer, own, member.orbit);
    writer.write_columns(own + "/passages", member.points, {units.length, "(q; q') at the section, full model"});
    writer.write_columns(own + "/path", member.path,
                         {units.length, "(q; q') at equal parts of each interval between passages, full model"});
    writer.write(own + "/intervals", member.intervals, {units.time, "from each passage to the next"});
  }
}

void store_comparison(StoreWriter& writer, const SkeletonComparison& comparison) {
  const std::string group = fmt::format("{}/comparison", kSkeletonGroup);
  writer.describe_group(group, "orbits of the full and of the reduced model; differences are reduced less full");
  std::vector<double> full, reduced;
  for (const OrbitMatch& match : comparison.matched) {
    full.push_back(static_cast<double>(match.full + 1));
    reduced.push_back(static_cast<double>(match.reduced + 1));
  }
  const Table matched{"orbits that both have",
                      joined({{{"full", {"", "number of the full model's orbit, from 1"}, full},
                               {"reduced", {"", "number of the reduced model's orbit, from 1"}, reduced}},
                              columns_of(comparison.matched)})};
  save(writer, group + "/matched", matched);
  writer.write(group + "/missed", numbers_of(comparison.missed), {"", "orbits of the full model without a partner"});
  writer.write(group + "/extra", numbers_of(comparison.extra), {"", "orbits of the reduced model without a partner"});
}

}  // namespace slipmode::results
