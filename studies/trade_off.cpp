#include <slipmode/studies/trade_off.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/trade_store.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/trade_words.hpp>
#include <slipmode/trade/variants.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <iterator>

namespace slipmode::studies {

TradeRequest trade_request(const TradeWords& words, const scene::Scene& scene) {
  TradeRequest out{.axes = trade::axes_of(scene), .product = words.product, .wish = {}};
  if (words.axes) out.axes = trade::parse_axes(*words.axes, out.axes);
  if (words.measure) out.wish.measure = parse_measure(*words.measure);
  if (words.error) out.wish.limit = parse_percent("--error", *words.error);
  if (words.budget) out.wish.budget = parse_duration("--budget", *words.budget);
  out.wish.duration = scene.time.duration;
  return out;
}

TradePlan trade_plan(const scene::Scene& scene, const TradeRequest& request, const RunOptions& run) {
  TradePlan out;
  if (std::ranges::find(request.axes, trade::Axis::kModes) != request.axes.end()) out.bases = offered_bases(scene, run);
  run.check_interrupt();
  out.variants = {trade::as_it_stands(scene)};
  for (const trade::Axis axis : request.axes)
    std::ranges::move(trade::along(axis, scene, out.bases), std::back_inserter(out.variants));
  if (request.product) std::ranges::move(trade::product(out.variants), std::back_inserter(out.variants));
  return out;
}

std::vector<std::string> TradeFound::recommendations(double limit) const {
  std::vector<std::string> out = trade::recommendations(study, limit);
  if (orbits) out.push_back(trade::recommendation(*orbits, limit));
  return out;
}

TradeFound trade_off(const scene::Scene& scene, const TradeRequest& request, const TradePlan& plan,
                     const RunOptions& run, results::Journal* journal) {
  trade::StudyOptions options{.schedule = trade::schedule_of(scene)};
  options.parallel = run.parallel("trade");
  if (journal != nullptr) results::keep_in(*journal, options);
  if (!request.product) {
    options.more = [limit = request.limit()](const std::vector<trade::Row>& rows) {
      return trade::worth_combining(rows, limit);
    };
  }
  TradeFound out{.study = trade::study(scene, trade::reference_of(scene), plan.variants, plan.bases, options)};
  std::vector<trade::OrbitMethod> methods;
  for (const trade::Axis axis : request.axes)
    std::ranges::move(trade::orbit_methods(axis, scene), std::back_inserter(methods));
  const bool timed = !std::isnan(out.study.reference.cost.cpu);
  if (timed && !methods.empty())
    out.orbits = trade::study_orbits(scene, methods, options.schedule.repeats, run.parallel("orbits"));
  return out;
}

std::string command_of(const TradeRequest& request) {
  return fmt::format("slipmode trade{}", request.product ? " --product" : "");
}

std::string identity_of(const TradeRequest& request) {
  std::string identity;
  for (const trade::Axis axis : request.axes) identity += trade::to_string(axis);
  return identity;
}

void store(results::StoreWriter& writer, const scene::Scene& scene, const TradeRequest& request,
           const TradeFound& found) {
  const std::string group = results::kTradeGroup;
  const trade::Study& study = found.study;
  results::store_study(writer, study, scene);
  if (found.orbits) results::store_orbits(writer, *found.orbits);
  writer.write(group + "/recommendations", found.recommendations(request.limit()), {"", "a sentence for each measure"});
  if (!request.chooses()) return;
  std::string name, sentence, text;
  try {
    const trade::Choice choice = trade::choose(study, request.wish);
    name = study.rows[choice.row].variant.name;
    sentence = choice.sentence;
    text = trade::scene_text(study.rows[choice.row].variant);
  } catch (const InvalidInput& refusal) {
    sentence = refusal.what();
  }
  writer.describe_group(group + "/choice", "the configuration that was picked");
  writer.write(group + "/choice/name", name, {"", "of the configuration; empty: none can be picked"});
  writer.write(group + "/choice/sentence", sentence, {"", "why it, or why none"});
  writer.write(group + "/choice/scene", text, {"", "the scene that it is (TOML)"});
}

}  // namespace slipmode::studies
