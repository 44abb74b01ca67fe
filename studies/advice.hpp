#pragma once

#include <slipmode/results/journal.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>
#include <slipmode/trade/lean.hpp>

#include <optional>
#include <string>
#include <vector>

namespace slipmode::studies {

/// What is asked of `advise`.
struct AdviceRequest {
  std::optional<trade::Question> question = {};  ///< empty: the one that the motion found can answer
  double bound = 2.0;                            ///< largest change of a measure [%]
  std::optional<trade::Measure> only = {};       ///< the one measure that counts
};

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

}  // namespace slipmode::studies
