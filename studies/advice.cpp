#include <slipmode/studies/advice.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/results/trade_store.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/studies/exponents.hpp>
#include <slipmode/studies/trade_words.hpp>
#include <slipmode/trade/advice.hpp>
#include <slipmode/trade/parting.hpp>
#include <slipmode/trade/variants.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <numbers>
#include <utility>

namespace slipmode::studies {
namespace {

/// Of what a motion on a belt reached from its start on: below that, and still falling, it dies out.
constexpr double kGone = 0.02;
constexpr int kPartingStarts = 8;

/// Of the largest exponent: what kind of motion there is, and what can be asked of it.
Asked by_the_motion(const scene::Scene& scene, double bound, const RunOptions& run) {
  Asked out{.ask = {.question = trade::Question::kStatistics}};
  const dynamics::HybridSystem system = scene::build_system(scene);
  const dynamics::State start = scene::initial_state(scene, system);
  try {
    const diagnostics::LyapunovSpectrum found = diagnostics::lyapunov_spectrum(
        system, start, tangent_options(scene, system, {.exponents = 1, .transient = {}, .duration = {}}, run));
    out.exponent = found.nats(0);
    out.exponent_error = found.error(0);
    const std::string figure =
        fmt::format("largest exponent {:.3g} ± {:.1g} {}", *out.exponent / std::numbers::ln2,
                    out.exponent_error / std::numbers::ln2, results::Units::of(scene.units).bit_rate());
    if (found.is_chaotic()) {
      out.sentence =
          fmt::format("The motion is chaotic ({}): paths part whatever is left out, its statistics need not.", figure);
      return out;
    }
    const trade::Case model = trade::build_case(trade::as_it_stands(scene), {});
    const trade::Schedule schedule = trade::schedule_of(scene);
    const trade::Parting found_there = trade::parting(model, found.end, kPartingStarts, schedule, run.stop);
    const trade::Parting at_first = trade::parting(model, start, 1, schedule, run.stop);
    trade::require_motion(at_first, found_there);
    out.dies_out = scene.drive.belt() != nullptr && *out.exponent + out.exponent_error < 0.0 &&
                   found_there.reach <= kGone * at_first.reach;
    if (out.dies_out) {
      out.ask.question = trade::Question::kMotion;
      out.sentence = fmt::format(
          "The motion dies out ({}): the way there counts, from the scene's start on, and "
          "statistics have nothing to be of.",
          figure);
      return out;
    }
    out.parting = found_there.apart;
    if (*out.parting > bound) {
      out.sentence = fmt::format(
          "Paths part: {} % up to the horizon from starts a millionth apart ({}), whatever is left "
          "out; statistics need not.",
          trade::percent_text(*out.parting), figure);
      return out;
    }
    out.ask.question = trade::Question::kMotion;
    out.sentence = found.is_undecided()
                       ? fmt::format(
                             "Whether the motion is chaotic is undecided ({}; a longer time.duration tells): "
                             "paths do not part up to the horizon, and are told.",
                             figure)
                       : fmt::format("The motion is regular ({}): it can be told where everything is.", figure);
  } catch (const NumericalFailure& failure) {
    out.sentence = fmt::format("Whether paths part could not be measured: {}.", failure.what());
  }
  return out;
}

/// A verdict for each of some rows, as columns.
results::Table judgements(const std::string& description, const std::vector<std::string>& names,
                          const std::vector<trade::Judgement>& all) {
  std::vector<std::string> verdicts, measures;
  std::vector<double> errors, noises;
  for (const trade::Judgement& own : all) {
    verdicts.emplace_back(trade::to_string(own.verdict));
    measures.emplace_back(trade::to_string(own.measure));
    errors.push_back(own.error);
    noises.push_back(own.noise);
  }
  return {description,
          {{"effect", {"", "what is left out, or added"}, names},
           {"verdict", {"", "needed, unclear, can be left out, cannot be run without"}, verdicts},
           {"measure", {"", "nearest to the bound, or furthest beyond"}, measures},
           {"error", {"%", "change of it"}, errors},
           {"noise", {"%", "its uncertainty"}, noises}}};
}

std::vector<std::string> names_of(const std::vector<trade::Effect>& effects, const std::vector<std::size_t>& some) {
  std::vector<std::string> names;
  names.reserve(some.size());
  for (const std::size_t e : some) names.push_back(effects[e].name);
  return names;
}

}  // namespace

AdviceRequest advice_request(const AdviceWords& words) {
  AdviceRequest out;
  if (words.error) out.bound = parse_percent("--error", *words.error);
  if (words.measure) out.only = parse_measure(*words.measure);
  if (!words.question) return out;
  for (const trade::Question question : {trade::Question::kMotion, trade::Question::kStatistics})
    if (trade::to_string(question) == *words.question) out.question = question;
  if (!out.question)
    throw InvalidInput(fmt::format("--question {}: no such question; valid: motion, statistics", *words.question));
  if (out.only && trade::question_of(*out.only) != *out.question) {
    throw InvalidInput(fmt::format("--measure {}: answers the question {}, not {}; give one of the two options",
                                   *words.measure, trade::to_string(trade::question_of(*out.only)), *words.question));
  }
  return out;
}

std::string command_of(const AdviceRequest&) { return "slipmode advise"; }

std::string identity_of(const AdviceRequest& request) { return fmt::format("{}", request.bound); }

Asked asked(const scene::Scene& scene, const AdviceRequest& request, const RunOptions& run) {
  Asked found = by_the_motion(scene, request.bound, run);
  if (request.question) found.ask.question = *request.question;
  if (request.only) found.ask.question = trade::question_of(*request.only);
  found.dies_out &= found.ask.question == trade::Question::kMotion;
  found.ask.bound = request.bound;
  found.ask.only = request.only;
  return found;
}

std::vector<trade::Variant> advice_pieces(const scene::Scene& scene, const std::vector<trade::Effect>& effects) {
  std::vector<trade::Variant> alone;
  for (std::size_t e = 0; e < effects.size(); ++e) alone.push_back(trade::without(scene, effects, {e}));
  return alone;
}

Advice advise(const scene::Scene& scene, std::vector<trade::Effect> effects, const AdviceRequest& request,
              const RunOptions& run, results::Journal* journal) {
  trade::StudyOptions options{.schedule = trade::schedule_of(scene), .resolve = request.bound};
  Advice out{.asked = asked(scene, request, run), .effects = std::move(effects), .study = {}};
  // From the scene's motion to a neighbouring one it is not as far as from a start.
  options.schedule.transient = std::min(options.schedule.transient, options.schedule.duration);
  options.dies_out = out.asked.dies_out;
  options.parallel = run.parallel("advise");
  if (journal != nullptr) results::keep_in(*journal, options);
  options.more = [&](const std::vector<trade::Row>& rows) {
    out.lean = trade::lean_scene(scene, out.effects, rows, out.asked.ask);
    return out.lean->wanted;
  };
  out.study = trade::study(scene, trade::as_it_stands(scene), advice_pieces(scene, out.effects), {}, options);
  return out;
}

std::string advice_text(const scene::Scene& scene, const Advice& advice) {
  return advice.asked.sentence + '\n' +
         trade::lean_sentences(scene, *advice.lean, advice.effects, advice.study, advice.asked.ask);
}

trade::Judgement judged(const Advice& advice, std::size_t effect, trade::Question question) {
  const trade::Ask& ask = advice.asked.ask;
  return trade::judge(advice.study.rows[advice.lean->alone[effect]],
                      question == ask.question ? ask : trade::Ask{.question = question, .bound = ask.bound});
}

trade::Variant lean_variant(const scene::Scene& scene, const Advice& advice) {
  return advice.lean->verified ? advice.study.rows[*advice.lean->verified].variant : trade::as_it_stands(scene);
}

void store(results::StoreWriter& writer, const scene::Scene& scene, const Advice& advice) {
  const std::string group = "advice";
  const trade::Lean& lean = *advice.lean;
  const trade::Ask& ask = advice.asked.ask;
  results::store_study(writer, advice.study, scene);
  writer.describe_group(group, "what the scene requires, and what it can do without");
  writer.write(group + "/sentences", advice_text(scene, advice), {"", "the answer"});
  writer.write(group + "/question", std::string(trade::to_string(ask.question)), {"", "that is answered"});
  writer.write(group + "/bound", ask.bound, {"%", "largest change of a measure"});
  std::vector<std::string> names;
  std::vector<trade::Judgement> alone, together;
  for (std::size_t e = 0; e < advice.effects.size(); ++e) {
    names.push_back(advice.effects[e].name);
    alone.push_back(judged(advice, e, ask.question));
  }
  results::save(writer, group + "/effects", judgements("every effect alone", names, alone));
  std::vector<std::size_t> tried;
  std::vector<double> out;
  for (const trade::Step& step : lean.steps) {
    tried.push_back(step.effect);
    out.push_back(step.left_out ? 1.0 : 0.0);
    together.push_back(trade::judge(advice.study.rows[step.row], ask));
  }
  results::Table steps = judgements("left out together, in this order", names_of(advice.effects, tried), together);
  steps.columns.push_back({"left_out", {"", "1: it is, 0: it stays"}, out});
  results::save(writer, group + "/steps", steps);
  writer.write(group + "/left_out", names_of(advice.effects, lean.left_out), {"", "effects the scene can do without"});
  writer.write(group + "/given_back", names_of(advice.effects, lean.put_back),
               {"", "left out by the steps, and needed by the whole"});
  writer.write(group + "/scene", trade::scene_text(lean_variant(scene, advice)),
               {"", "the scene with only what it requires (TOML)"});
}

}  // namespace slipmode::studies
