#include <slipmode/trade/lean.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/trade/advice.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace slipmode::trade {

namespace {

constexpr std::array<std::string_view, 4> kVerdicts = {"needed", "unclear", "can be left out", "cannot be run without"};
/// Standard errors that an error must be beyond the bound; within it, one is assured (Offer::assured).
constexpr double kBeyond = 2.0;
/// Sets measured at a time: threads have work, and little of it is in vain where the bound breaks.
constexpr std::size_t kAhead = 4;

bool goes_further(const std::vector<Effect>& effects, std::size_t further, std::size_t than) {
  return further > than && !effects[than].ladder.empty() && effects[further].ladder == effects[than].ladder;
}

/// Whether something of a set goes further than an effect.
bool is_passed(const std::vector<Effect>& effects, const std::vector<std::size_t>& set, std::size_t effect) {
  return std::ranges::any_of(set, [&](std::size_t other) { return goes_further(effects, other, effect); });
}

class Search {
 public:
  Search(const scene::Scene& scene, const std::vector<Effect>& effects, const std::vector<Row>& rows, const Ask& ask)
      : scene_(scene), effects_(effects), rows_(rows), ask_(ask) {}

  Lean run() {
    std::vector<std::size_t> queue = spare_alone();
    while (!queue.empty() && out_.wanted.empty()) walk(queue);
    if (out_.wanted.empty()) verify();
    out_.left_out = furthest(effects_, std::move(out_.left_out));
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::optional<std::size_t> row_named(const std::string& name) const {
    const auto found = std::ranges::find(rows_, name, [](const Row& row) { return row.variant.name; });
    if (found == rows_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - rows_.begin());
  }
  [[nodiscard]] std::optional<std::size_t> row_without(const std::vector<std::size_t>& set) const {
    return row_named(without(scene_, effects_, set).name);
  }
  [[nodiscard]] bool keeps(std::size_t row) const { return judge(rows_[row], ask_).verdict == Verdict::kSpare; }

  /// Effects that can be left out alone, the least change first.
  std::vector<std::size_t> spare_alone() {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t e = 0; e < effects_.size(); ++e) {
      const auto row = row_without({e});
      if (!row) throw InvalidInput(fmt::format("lean scene: no row for effect \"{}\"", effects_[e].name));
      out_.alone.push_back(*row);
      const Judgement found = judge(rows_[*row], ask_);
      if (effects_[e].removable && found.verdict == Verdict::kSpare) order.emplace_back(found.error, e);
    }
    std::ranges::sort(order);
    std::vector<std::size_t> queue;
    for (const auto& [error, e] : order) queue.push_back(e);
    return queue;
  }

  /// Tries the queue's effects one after the other until one breaks the bound, or rows are missing.
  void walk(std::vector<std::size_t>& queue) {
    std::vector<std::size_t> set = out_.left_out;
    for (std::size_t k = 0; k < queue.size(); ++k) {
      const std::size_t e = queue[k];
      if (is_passed(effects_, set, e)) continue;
      set.push_back(e);
      const auto row = row_without(set);
      if (!row) {
        want(queue, k);
        return;
      }
      out_.steps.push_back({.effect = e, .row = *row, .left_out = keeps(*row)});
      if (!out_.steps.back().left_out) {
        queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(k) + 1);
        std::erase_if(queue, [&](std::size_t other) { return goes_further(effects_, other, e); });
        return;
      }
      out_.left_out.push_back(e);
    }
    queue.clear();
  }

  /// The next sets, as if each kept to the bound.
  void want(const std::vector<std::size_t>& queue, std::size_t from) {
    std::vector<std::size_t> set = out_.left_out;
    for (std::size_t k = from; k < queue.size() && out_.wanted.size() < kAhead; ++k) {
      if (is_passed(effects_, set, queue[k])) continue;
      set.push_back(queue[k]);
      if (!row_without(set)) out_.wanted.push_back(without(scene_, effects_, set));
    }
  }

  /// What is left out is measured as a whole; where that does not keep to the bound, the one effect is given back
  /// without which it does, the last one if there is none, and it is measured again.
  void verify() {
    while (!out_.left_out.empty()) {
      const auto row = whole(out_.left_out);
      if (!row) return;
      if (stands(*row)) {
        out_.verified = *row;
        return;
      }
      give_back();
      if (!out_.wanted.empty()) return;
    }
  }

  /// The row of a set as it is written; wanted where it is missing.
  std::optional<std::size_t> whole(const std::vector<std::size_t>& set) {
    Variant written = without(scene_, effects_, set);
    written.name = "lean scene " + written.name;
    const auto row = row_named(written.name);
    if (row) return row;
    written.axis = Axis::kLean;
    written.scene = scene::with_own_times(scene::parse_scene(scene_text(written), {}, scene_.source.path));
    out_.wanted.push_back(std::move(written));
    return std::nullopt;
  }

  /// It answers the question, and is the same motion otherwise: one end of another start is no answer.
  [[nodiscard]] bool stands(std::size_t row) const { return keeps(row) && is_alike(rows_[row], ask_.bound); }

  void give_back() {
    std::vector<std::size_t>& set = out_.left_out;
    auto chosen = static_cast<std::ptrdiff_t>(set.size()) - 1;
    for (std::ptrdiff_t k = chosen; set.size() > 1 && k >= 0; --k) {
      std::vector<std::size_t> others = set;
      others.erase(others.begin() + k);
      const auto row = whole(others);
      if (!row || !stands(*row)) continue;
      chosen = k;
      break;
    }
    if (!out_.wanted.empty()) return;
    out_.put_back.push_back(*(set.begin() + chosen));
    set.erase(set.begin() + chosen);
  }

  const scene::Scene& scene_;
  const std::vector<Effect>& effects_;
  const std::vector<Row>& rows_;
  const Ask& ask_;
  Lean out_;  ///< its left_out in the order of the steps
};

/// "a, b and c".
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k) {
    text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
  }
  return text;
}

std::string time_text(double share) {
  constexpr double kSame = 0.05;
  if (!std::isfinite(share)) return "its time is not known";
  if (std::abs(share - 1.0) < kSame) return "a run takes as long";
  return fmt::format("a run takes {:.2g} of the time", share);
}

std::string asked_for(Question question) {
  return question == Question::kMotion ? "the motion up to the horizon" : "the statistics";
}

}  // namespace

std::string_view to_string(Verdict verdict) { return kVerdicts[static_cast<std::size_t>(verdict)]; }

Judgement judge(const Row& row, const Ask& ask) {
  if (!row.failure.empty()) return {.verdict = Verdict::kFailed, .error = kNone, .noise = kNone};
  Judgement out{.error = kNone, .noise = kNone};
  double largest = -1.0;
  bool beyond = false;
  for (std::size_t m = 0; m < kMeasures; ++m) {
    const auto measure = static_cast<Measure>(m);
    const double error = row.error[m], noise = row.noise[m];
    const bool counts = ask.only ? *ask.only == measure : question_of(measure) == ask.question;
    if (!counts || std::isnan(error) || std::isnan(noise)) continue;
    const bool now = error - kBeyond * noise > ask.bound;
    const double reach = now ? error - kBeyond * noise : row.offer(measure).assured();
    if (now < beyond || (now == beyond && reach <= largest)) continue;
    beyond = now;
    largest = reach;
    out = {.measure = measure, .error = error, .noise = noise};
  }
  out.verdict = beyond ? Verdict::kNeeded : largest < 0.0 || largest > ask.bound ? Verdict::kUnclear : Verdict::kSpare;
  return out;
}

std::string error_text(const Judgement& judgement) {
  return fmt::format("{} {} ± {} %", to_string(judgement.measure), percent_text(judgement.error),
                     percent_text(judgement.noise));
}

Lean lean_scene(const scene::Scene& scene, const std::vector<Effect>& effects, const std::vector<Row>& rows,
                const Ask& ask) {
  return Search(scene, effects, rows, ask).run();
}

std::string lean_sentences(const scene::Scene& scene, const Lean& lean, const std::vector<Effect>& effects,
                           const Study& study, const Ask& ask) {
  std::vector<std::string> required, unclear, spare, mattering;
  for (std::size_t e = 0; e < effects.size(); ++e) {
    const Judgement alone = judge(study.rows[lean.alone[e]], ask);
    if (effects[e].kind == EffectKind::kAddition && alone.verdict == Verdict::kNeeded) {
      mattering.push_back(fmt::format("{} ({})", effects[e].name, error_text(alone)));
    }
    if (!effects[e].removable) continue;
    if (is_passed(effects, lean.left_out, e)) continue;
    if (std::ranges::find(lean.left_out, e) != lean.left_out.end()) {
      spare.push_back(effects[e].name);
      continue;
    }
    const bool nearer_stays =
        e > 0 && goes_further(effects, e, e - 1) && std::ranges::find(lean.left_out, e - 1) == lean.left_out.end();
    if (!nearer_stays) (alone.verdict == Verdict::kUnclear ? unclear : required).push_back(effects[e].name);
  }
  const std::string none = unclear.empty() ? "none of its effects" : "none of its effects for certain";
  std::string text = fmt::format("For {} within {} % the scene requires {}.",
                                 ask.only ? std::string(to_string(*ask.only)) : asked_for(ask.question),
                                 percent_text(ask.bound), required.empty() ? none : listed(required));
  if (lean.verified) {
    const Row& whole = study.rows[*lean.verified];
    text += fmt::format(" It can do without {}{}: {} off, measured once more as a whole, and {}.", listed(spare),
                        spare.size() > 1 ? ", together" : "", error_text(judge(whole, ask)),
                        time_text(time_share(study, whole)));
  }
  text += '\n';
  if (!unclear.empty()) {
    text += fmt::format(
        "Not to be told within {} % from scatter, and kept: {}. A larger bound, or longer records ({}), would tell.\n",
        percent_text(ask.bound), listed(unclear),
        scene.drive.belt() != nullptr     ? "validation.limit, validation.kept"
        : scene.drive.shaker() != nullptr ? "validation.cycles, validation.kept"
                                          : "time.cycles");
  }
  if (!mattering.empty()) text += fmt::format("It leaves out what would matter: {}.\n", listed(mattering));
  return text;
}

}  // namespace slipmode::trade
