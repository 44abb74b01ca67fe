#pragma once

#include <slipmode/trade/study.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::trade {

/// False where some number of the settled motion (kPoints … kStick) is further off than ten times the limit and three
/// times its scatter: then another one that is within the limit is so by chance. No such row is chosen.
[[nodiscard]] bool is_alike(const Row& row, double limit);

/// What a user asks for.
struct Wish {
  Measure measure = Measure::kDe;
  std::optional<double> limit = {};   ///< largest error [%]
  std::optional<double> budget = {};  ///< largest processor time of one run, set-up included [s]
  double duration = 0.0;              ///< length of that run ([time].duration) [s]
};

/// A configuration picked, and why, in one sentence.
struct Choice {
  std::size_t row = 0;  ///< of the study
  std::string sentence;
};

/// With a limit the cheapest configuration that is assured to keep to it; with a budget the most accurate one within;
/// with both the cheapest that keeps to both. "Assured": error and noise together are below the limit.
/// @throws InvalidInput  when there is none: the message says the most accurate, or the cheapest, that exists
[[nodiscard]] Choice choose(const Study& study, const Wish& wish);

/// One sentence for a limit, whether or not it can be met.
[[nodiscard]] std::string recommendation(const Study& study, Measure measure, double limit);

/// One sentence per measure, for the same limit [%].
[[nodiscard]] std::vector<std::string> recommendations(const Study& study, double limit);

/// Reduced models with a looser flow, worth trying: for each measure and each basis the smallest model that is assured
/// to keep to the limit, with the two loosest flows that do. Each once; with all modes there is nothing to combine.
/// @param rows  measured already, without their costs
[[nodiscard]] std::vector<Variant> worth_combining(const std::vector<Row>& rows, double limit);

/// Processor time of the scene as it stands over that of a row; NaN where either is not known.
[[nodiscard]] double speed_up(const Study& study, const Row& row);
/// Its inverse: what a run takes of the time.
[[nodiscard]] double time_share(const Study& study, const Row& row);

/// Runs of that length after which basis and projection are paid for, against the scene as it stands; infinite when the
/// row is not faster, 0 for a full model that is.
[[nodiscard]] double break_even(const Study& study, const Row& row, double duration);

/// "0.43", "12", "3.1e-07": two or three digits.
[[nodiscard]] std::string percent_text(double value);

}  // namespace slipmode::trade
