#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>
#include <slipmode/trade/lean.hpp>

#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace slipmode::studies {

/// What is asked of `advise`, as a user says it.
struct AdviceWords {
  std::optional<std::string> question = {}, measure = {}, error = {};

  static constexpr auto fields() {
    using Own = AdviceWords;
    return std::tuple{
        optional("question", &Own::question, "",
                 "motion: where everything is up to the horizon; statistics: of the settled motion; default: the one "
                 "that the motion found can answer"),
        optional("measure", &Own::measure, "",
                 "the one measure that counts: dX, dE, points, spread, energy, stick; default: all of the question"),
        optional("error", &Own::error, "", "bound of what may change; default 2%")};
  }
};

/// The same, understood.
struct AdviceRequest {
  std::optional<trade::Question> question = {};  ///< empty: the one that the motion found can answer
  double bound = 2.0;                            ///< largest change of a measure [%]
  std::optional<trade::Measure> only = {};       ///< the one measure that counts
};

/// @throws InvalidInput  for words that are none, and a measure that does not answer the question
[[nodiscard]] AdviceRequest advice_request(const AdviceWords& words);
/// As the executable would be asked, for provenance; and what else decides what is measured.
[[nodiscard]] std::string command_of(const AdviceRequest& request);
[[nodiscard]] std::string identity_of(const AdviceRequest& request);

/// Which question is answered, and why.
struct Asked {
  trade::Ask ask;
  std::string sentence = {};            ///< about the motion found; empty where the question was given
  std::optional<double> exponent = {};  ///< largest Lyapunov exponent [1/s]; empty: not measured
  double exponent_error = 0.0;          ///< its standard error [1/s]
  std::optional<double> parting = {};   ///< trade::Parting::apart; empty: not measured [%]
  bool dies_out = false;                ///< the motion: it is asked for from the scene's start on
};

/// The question as requested; else, from the largest exponent of the motion: of a chaotic one its statistics, as paths
/// part whatever is left out, and so of one whose paths part by more than the bound from starts a millionth apart
/// (trade::parting); of others where everything is, up to the horizon. A motion on a belt that ends up within a
/// fiftieth of what it reached from its start on dies out: it has no statistics.
/// @throws Interrupted  if the stop flag was set
[[nodiscard]] Asked asked(const scene::Scene& scene, const AdviceRequest& request, const RunOptions& run = {});

/// What a scene requires to answer, and what it could do without.
struct Advice {
  Asked asked;
  std::vector<trade::Effect> effects;
  trade::Study study;  ///< against the scene as it stands: every effect alone, then together, then the lean scene
  /// Empty where some effects are left to other processes.
  std::optional<trade::Lean> lean = {};
};

/// The pieces that processes can share: every effect alone. The rest is computed where the parts are joined.
[[nodiscard]] std::vector<trade::Variant> advice_pieces(const scene::Scene& scene,
                                                        const std::vector<trade::Effect>& effects);

/// Measures every effect alone, leaves out together what can be, and measures what remains once more.
/// @param scene    with its own times (scene::with_own_times)
/// @param effects  those of the scene (trade::effects_of)
/// @param journal  keeps what is measured and gives back what was; nullptr: in memory only
/// @throws as trade::study
[[nodiscard]] Advice advise(const scene::Scene& scene, std::vector<trade::Effect> effects, const AdviceRequest& request,
                            const RunOptions& run = {}, results::Journal* journal = nullptr);

/// What was found and what follows, in sentences, a line each. @param advice  with a lean scene
[[nodiscard]] std::string advice_text(const scene::Scene& scene, const Advice& advice);
/// The answer to one question alone, of every effect.
[[nodiscard]] trade::Judgement judged(const Advice& advice, std::size_t effect, trade::Question question);
/// With only what the scene requires; itself where nothing can be left out.
[[nodiscard]] trade::Variant lean_variant(const scene::Scene& scene, const Advice& advice);

/// What is kept: every row, the sentences, a verdict for each effect, the steps, and the lean scene.
void store(results::StoreWriter& writer, const scene::Scene& scene, const Advice& advice);

}  // namespace slipmode::studies
