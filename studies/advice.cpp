#include <slipmode/studies/advice.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/trade_store.hpp>
#include <slipmode/studies/exponents.hpp>
#include <slipmode/trade/advice.hpp>
#include <slipmode/trade/parting.hpp>
#include <slipmode/trade/variants.hpp>

#include <fmt/format.h>
#include <algorithm>
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
    const std::string figure = fmt::format("largest exponent {:.3g} ± {:.1g} {}", *out.exponent, out.exponent_error,
                                           scene.units == "SI" ? "1/s" : "per unit of time");
    if (found.is_chaotic()) {
      out.sentence =
          fmt::format("The motion is chaotic ({}): paths part whatever is left out, its statistics need not.", figure);
      return out;
    }
    const trade::Case model = trade::build_case(trade::as_it_stands(scene), {});
    const trade::Schedule schedule = trade::schedule_of(scene);
    const trade::Parting found_there = trade::parting(model, found.end, kPartingStarts, schedule, run.stop);
    const trade::Parting at_first = trade::parting(model, start, 1, schedule, run.stop);
    if (found_there.reach == 0.0 && at_first.reach == 0.0)
      throw InvalidInput(
          "initial: nothing moves from the scene's start on, so there is nothing to advise about; give "
          "initial.displacement or initial.velocity, or initial.at = \"rest\"");
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
    out.sentence = fmt::format("The motion is regular ({}): it can be told where everything is.", figure);
  } catch (const NumericalFailure& failure) {
    out.sentence = fmt::format("Whether paths part could not be measured: {}.", failure.what());
  }
  return out;
}

}  // namespace

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

}  // namespace slipmode::studies
