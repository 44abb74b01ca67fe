#include <slipmode/trade/advice.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/trade/variants.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace slipmode::trade {

namespace {

/// Where it is the reference it has no row of its own.
const Row& row_as_it_stands(const Study& study) {
  const auto found = std::ranges::find(study.rows, Axis::kScene, [](const Row& row) { return row.variant.axis; });
  return found == study.rows.end() ? study.reference : *found;
}

std::string error_text(const Row& row, Measure measure) {
  return fmt::format("{} {} ± {} %", to_string(measure), percent_text(at(row.error, measure)),
                     percent_text(at(row.noise, measure)));
}

/// "23 times faster than", "as fast as", "1.4 times slower than the scene as it stands".
std::string speed_text(double ratio) {
  constexpr double kSame = 0.1;
  if (!std::isfinite(ratio)) return "not compared with the scene as it stands";
  if (std::abs(ratio - 1.0) < kSame) return "about as fast as the scene as it stands";
  const double factor = ratio > 1.0 ? ratio : 1.0 / ratio;
  return fmt::format("{} times {} than the scene as it stands", percent_text(factor),
                     ratio > 1.0 ? "faster" : "slower");
}

std::string use_text(const Study& study, const Row& row, Measure measure) {
  if (row.variant.axis == Axis::kScene) {
    return fmt::format("use the scene as it stands: nothing cheaper that was tried will do ({})",
                       error_text(row, measure));
  }
  return fmt::format("use {}: {} ({})", row.variant.name, speed_text(speed_up(study, row)), error_text(row, measure));
}

/// All modes: the full model in other coordinates.
bool keeps_all(const Variant& variant) { return variant.reduction && variant.reduction->modes == variant.scene.size(); }

/// Offers of a measure without those that reduce nothing or, under a limit, agree by chance.
std::vector<Offer> sound_offers(const Study& study, Measure measure, std::optional<double> limit) {
  std::vector<Offer> offers = study.offers(measure);
  for (std::size_t i = 0; i < offers.size(); ++i) {
    const Row& row = study.rows[i];
    if (keeps_all(row.variant) || (limit && !is_alike(row, *limit))) offers[i].error = kNone;
  }
  return offers;
}

/// The cheapest within a limit; but the scene as it stands, where that will do and the other is hardly faster.
std::optional<std::size_t> cheapest_worth_it(const Study& study, const std::vector<Offer>& offers, double limit) {
  constexpr double kHardly = 1.1;
  const auto picked = cheapest_within_error(offers, limit);
  if (!picked || !(speed_up(study, study.rows[*picked]) < kHardly)) return picked;
  for (std::size_t i = 0; i < offers.size(); ++i) {
    const bool own = study.rows[i].variant.axis == Axis::kScene;
    if (own && offers[i].known() && offers[i].assured() <= limit) return i;
  }
  return picked;
}

/// With a budget costs are those of one whole run; with a budget alone any error may have to do.
std::vector<Offer> offers_of_run(const Study& study, const Wish& wish) {
  std::vector<Offer> offers = sound_offers(study, wish.measure, wish.limit);
  if (!wish.budget) return offers;
  for (std::size_t i = 0; i < offers.size(); ++i) offers[i].cost = study.rows[i].cost.of_run(wish.duration);
  return offers;
}

[[noreturn]] void refuse_limit(const Study& study, const Wish& wish, const std::vector<Offer>& offers) {
  const auto best = most_accurate(offers);
  const std::string nearest =
      best ? fmt::format("{} ({})", study.rows[*best].variant.name, error_text(study.rows[*best], wish.measure))
           : std::string("none, all failed");
  throw InvalidInput(fmt::format(
      "no configuration is assured to keep {} under {} %; the most accurate that exists: {}. Ask for more, for another "
      "--measure, or record longer where the noise is what is too large",
      to_string(wish.measure), percent_text(*wish.limit), nearest));
}

[[noreturn]] void refuse_budget(const Study& study, const Wish& wish, const std::vector<Offer>& offers) {
  const auto least = cheapest(offers);
  const std::string nearest = least ? fmt::format("{}, {:.3g} s ({})", study.rows[*least].variant.name,
                                                  offers[*least].cost, error_text(study.rows[*least], wish.measure))
                                    : std::string("none, all failed");
  const std::string within =
      wish.limit ? fmt::format(" that keeps {} under {} %", to_string(wish.measure), percent_text(*wish.limit))
                 : std::string();
  throw InvalidInput(
      fmt::format("no configuration{} runs {:g} time units within a budget of {:.3g} s; the cheapest that "
                  "exists: {}",
                  within, wish.duration, *wish.budget, nearest));
}

}  // namespace

bool is_alike(const Row& row, double limit) {
  constexpr double kFar = 10.0, kBeyondScatter = 3.0;
  return std::ranges::none_of(std::array{Measure::kPoints, Measure::kSpread, Measure::kEnergy, Measure::kStick},
                              [&](Measure measure) {
                                const double error = at(row.error, measure), noise = at(row.noise, measure);
                                return error > kFar * limit && error > kBeyondScatter * noise;
                              });
}

std::string percent_text(double value) {
  if (std::isnan(value)) return "–";
  if (value >= 10.0) return fmt::format("{:.0f}", value);
  if (value >= 0.01) return fmt::format("{:.2g}", value);
  return value > 0.0 ? fmt::format("{:.1e}", value) : "0";
}

double speed_up(const Study& study, const Row& row) { return row_as_it_stands(study).cost.cpu / row.cost.cpu; }

double time_share(const Study& study, const Row& row) { return 1.0 / speed_up(study, row); }

double break_even(const Study& study, const Row& row, double duration) {
  if (!std::isfinite(row.cost.cpu)) return kNone;
  const double saved = (row_as_it_stands(study).cost.cpu - row.cost.cpu) * duration / row.cost.simulated;
  if (!(saved > 0.0)) return std::numeric_limits<double>::infinity();
  return row.basis_seconds > 0.0 ? (row.basis_seconds + row.cost.setup) / saved : 0.0;
}

Choice choose(const Study& study, const Wish& wish) {
  std::vector<Offer> offers = offers_of_run(study, wish);
  std::optional<std::size_t> picked;
  std::string asked;
  if (wish.limit) {
    picked = cheapest_worth_it(study, offers, *wish.limit);
    if (!picked) refuse_limit(study, wish, offers);
    if (wish.budget && offers[*picked].cost > *wish.budget) picked = cheapest_within_error(offers, *wish.limit);
    if (wish.budget && offers[*picked].cost > *wish.budget) refuse_budget(study, wish, offers);
    asked = fmt::format("for {} under {} %", to_string(wish.measure), percent_text(*wish.limit));
    if (wish.budget) asked += fmt::format(" within {:.3g} s", *wish.budget);
  } else if (wish.budget) {
    picked = best_within_budget(offers, *wish.budget);
    if (!picked) refuse_budget(study, wish, offers);
    asked = fmt::format("within {:.3g} s a run", *wish.budget);
  } else {
    throw InvalidInput("choose: expected a limit or a budget, found neither");
  }
  return {.row = *picked, .sentence = fmt::format("{} {}", asked, use_text(study, study.rows[*picked], wish.measure))};
}

std::vector<std::string> recommendations(const Study& study, double limit) {
  std::vector<std::string> out;
  for (std::size_t m = 0; m < kMeasures; ++m) {
    const auto measure = static_cast<Measure>(m);
    if (study.dies_out && question_of(measure) == Question::kStatistics) continue;
    out.push_back(recommendation(study, measure, limit));
  }
  return out;
}

std::vector<Variant> worth_combining(const std::vector<Row>& rows, double limit) {
  constexpr std::size_t kLoosest = 2;
  std::vector<Variant> all;
  const auto add = [&](const Variant& reduced, const std::vector<const Variant*>& flows) {
    for (std::size_t k = 0; k < std::min(kLoosest, flows.size()); ++k) {
      Variant both = combined(reduced, *flows[k]);
      if (std::ranges::find(all, both.name, &Variant::name) == all.end()) all.push_back(std::move(both));
    }
  };
  for (std::size_t m = 0; m < kMeasures; ++m) {
    const auto measure = static_cast<Measure>(m);
    const auto keeps = [&](const Row& row) {
      const Offer offer{.cost = 0.0, .error = at(row.error, measure), .noise = at(row.noise, measure)};
      return offer.known() && offer.assured() <= limit;
    };
    std::vector<const Variant*> flows;
    for (const Row& row : rows) {
      if (row.variant.axis == Axis::kFlow && keeps(row)) flows.push_back(&row.variant);
    }
    std::map<scene::BasisChoice, const Variant*> smallest;
    for (const Row& row : rows) {
      if (row.variant.axis != Axis::kModes || !keeps(row) || !is_alike(row, limit)) continue;
      if (keeps_all(row.variant)) continue;
      const Variant*& known = smallest[row.variant.reduction->basis];
      if (known == nullptr || row.variant.reduction->modes < known->reduction->modes) known = &row.variant;
    }
    for (const auto& [basis, reduced] : smallest) add(*reduced, flows);
  }
  return all;
}

std::string recommendation(const Study& study, Measure measure, double limit) {
  const std::vector<Offer> offers = sound_offers(study, measure, limit);
  const std::string asked = fmt::format("for {} under {} %", to_string(measure), percent_text(limit));
  if (const auto picked = cheapest_worth_it(study, offers, limit)) {
    return fmt::format("{} {}", asked, use_text(study, study.rows[*picked], measure));
  }
  const auto best = most_accurate(offers);
  if (!best) return fmt::format("{} nothing that was tried will do, or the measure has no value here", asked);
  return fmt::format("{} not assured by anything that was tried; nearest is {} ({})", asked,
                     study.rows[*best].variant.name, error_text(study.rows[*best], measure));
}

}  // namespace slipmode::trade
