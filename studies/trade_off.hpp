#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>
#include <slipmode/trade/advice.hpp>
#include <slipmode/trade/orbit_methods.hpp>
#include <slipmode/trade/study.hpp>

#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace slipmode::studies {

/// What is asked of `trade`, as a user says it.
struct TradeWords {
  std::optional<std::string> axes = {}, measure = {};  ///< else all the scene has, dE
  std::optional<std::string> error = {}, budget = {};
  bool product = false;

  static constexpr auto fields() {
    using Own = TradeWords;
    return std::tuple{
        optional("axes", &Own::axes, "",
                 "what is varied: modes, flow, theory, elements, law, load; of the periodic orbit under a force "
                 "harmonics, samples, "
                 "mixed; default: all the scene has"),
        optional("product", &Own::product, "", "every reduced model with every flow, not only the promising ones"),
        optional("measure", &Own::measure, "", "what error limits: dX, dE, points, spread, energy, stick; default dE"),
        optional("error", &Own::error, "", "pick the cheapest that keeps to it, e.g. 1%"),
        optional("budget", &Own::budget, "",
                 "pick the most accurate whose run of [time] takes no more processor time, e.g. 10s")};
  }
};

/// The same, understood.
struct TradeRequest {
  std::vector<trade::Axis> axes;
  bool product = false;
  trade::Wish wish;

  /// [%], where none is asked for 1
  [[nodiscard]] double limit() const { return wish.limit.value_or(1.0); }
  /// A configuration is to be picked.
  [[nodiscard]] bool chooses() const { return wish.limit || wish.budget; }
};
/// @throws InvalidInput  for words that are none, and axes that the scene does not have
[[nodiscard]] TradeRequest trade_request(const TradeWords& words, const scene::Scene& scene);

/// What will be measured before anything is known: the scene as it stands first.
struct TradePlan {
  std::vector<trade::OfferedBasis> bases;
  std::vector<trade::Variant> variants;
};
/// @param scene  with its own times (scene::with_own_times); may take its time, as bases are made
/// @throws Interrupted  when the stop flag was set
[[nodiscard]] TradePlan trade_plan(const scene::Scene& scene, const TradeRequest& request, const RunOptions& run = {});

struct TradeFound {
  trade::Study study;
  /// Where an axis is of periodic orbits, and times were taken.
  std::optional<trade::OrbitStudy> orbits = {};

  /// A sentence for each measure, and for the orbit. @param limit  [%]
  [[nodiscard]] std::vector<std::string> recommendations(double limit) const;
};

/// Configurations along the axes against the best affordable model of the scene; reduced models and flows that are
/// promising together too. Then ways to the scene's periodic orbit, along the axes of those.
/// @param journal  keeps what is measured and gives back what was; nullptr: in memory only
/// @throws as trade::study
[[nodiscard]] TradeFound trade_off(const scene::Scene& scene, const TradeRequest& request, const TradePlan& plan,
                                   const RunOptions& run = {}, results::Journal* journal = nullptr);

/// As the executable would be asked, for provenance; and what else decides what is measured.
[[nodiscard]] std::string command_of(const TradeRequest& request);
[[nodiscard]] std::string identity_of(const TradeRequest& request);

/// What is kept: every row, a sentence for each measure and, where one was to be picked, the choice and its scene, or
/// why there is none.
void store(results::StoreWriter& writer, const scene::Scene& scene, const TradeRequest& request,
           const TradeFound& found);

}  // namespace slipmode::studies
