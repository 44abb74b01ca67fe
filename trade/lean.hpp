#pragma once

#include <slipmode/trade/effects.hpp>
#include <slipmode/trade/study.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slipmode::trade {

/// What leaving something out comes to.
enum class Verdict {
  kNeeded,   ///< some measure changes by more than the bound, twice its uncertainty taken off
  kUnclear,  ///< neither: its uncertainty decides, or there is nothing to measure
  kSpare,    ///< every one is assured to change by less than the bound (Offer::assured)
  kFailed,   ///< the scene cannot be run without it
};
/// "needed", "unclear", "can be left out", "cannot be run without".
[[nodiscard]] std::string_view to_string(Verdict verdict);

/// What a scene is to answer, and how well.
struct Ask {
  Question question = Question::kStatistics;
  double bound = 2.0;                ///< largest change of a measure [%]
  std::optional<Measure> only = {};  ///< the one measure that counts; empty: all of the question
};

/// A row judged by the measure that is nearest to the bound, or furthest beyond it.
struct Judgement {
  Verdict verdict = Verdict::kUnclear;
  Measure measure = Measure::kDx;
  double error = 0.0, noise = 0.0;  ///< of that measure; NaN where nothing was measured [%]
};
[[nodiscard]] Judgement judge(const Row& row, const Ask& ask);
/// "points 0.43 ± 0.1 %".
[[nodiscard]] std::string error_text(const Judgement& judgement);

/// Effects tried to be left out together with all those left out before.
struct Step {
  std::size_t effect = 0;  ///< tried
  std::size_t row = 0;     ///< of the study: without it and those left out before
  bool left_out = false;   ///< false: the bound breaks, it stays
};

/// A scene with only what it requires.
struct Lean {
  std::vector<std::size_t> alone;  ///< the row of each effect left out, or added, alone
  std::vector<Step> steps;
  std::vector<std::size_t> left_out;    ///< effects, ascending; empty: none
  std::optional<std::size_t> verified;  ///< the row that measured it as a whole; none where nothing is left out
  std::vector<std::size_t> put_back;    ///< left out by `steps`, and given back as the whole did not keep to the bound
  std::vector<Variant> wanted;          ///< to be measured before more can be said; empty: this is the end
};

/// Leaves out effects together, greedily: of those that can be left out alone the one that changes least first, each
/// with all before it, until none is left that keeps to the bound; where one breaks it, that one stays and the next is
/// tried. What remains is written as a scene, read back and measured once more as a whole, on runs of the reference
/// that decided nothing (Axis::kLean); where it does not keep to the bound, the last effect is given back.
///
/// A function of the rows measured so far: first of every effect alone, then, again and again, of what it wants.
/// @param rows  one per effect, named as `without` names them, and any others
/// @throws InvalidInput  when rows of single effects are missing
[[nodiscard]] Lean lean_scene(const scene::Scene& scene, const std::vector<Effect>& effects,
                              const std::vector<Row>& rows, const Ask& ask);

/// What a scene requires to answer, what it can do without and what that saves, what cannot be told, and what it leaves
/// out that would matter: a sentence each, where there is something to say.
[[nodiscard]] std::string lean_sentences(const scene::Scene& scene, const Lean& lean,
                                         const std::vector<Effect>& effects, const Study& study, const Ask& ask);

}  // namespace slipmode::trade
