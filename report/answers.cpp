#include "report/internal/answers.hpp"

#include <slipmode/fem/beam.hpp>
#include <slipmode/friction/contact.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/scene/driven.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>

namespace slipmode::report {
namespace {

using results::StoreReader;
using results::Table;

/// Slip states within so many times the distance of two full runs are taken for the full model's own, as in
/// diagnostics::ValidationOptions::grow.
constexpr double kScatter = 3.0;
/// What counts as good: deviations on periodic orbits [%], and how many times faster.
constexpr double kAccurate = 5.0, kPays = 1.5;

Json answer(const char* question, std::string text, const char* tone) {
  return {{"question", question}, {"answer", std::move(text)}, {"tone", tone}};
}

std::string structure_text(const scene::Scene& scene) {
  if (const fem::ChainOptions* chain = scene.chain()) return fmt::format("A chain of {} masses", chain->masses);
  if (const fem::BeamOptions* beam = scene.beam()) {
    double length = 0.0;
    for (const fem::BeamSpan& span : beam->spans) length += span.length;
    return fmt::format("A beam of {:g} m with {} degrees of freedom", length, scene.size());
  }
  return fmt::format("A structure with {} degree{} of freedom", scene.size(), scene.size() == 1 ? "" : "s");
}

std::string drive_text(const scene::Scene& scene) {
  if (scene.force)
    return fmt::format("driven by a force at {} = {:g}", scene.force->frequency_hz ? "f" : "ω",
                       scene::drive_parameter(scene));
  if (is_shaken(scene)) return fmt::format("shaken at {:g} Hz", scene::drive_parameter(scene));
  return fmt::format("on a belt at V = {:g}", scene::drive_parameter(scene));
}

/// Of the basis that numbers of modes are chosen by, in the order of their numbers.
struct Levels {
  std::string basis;
  std::vector<double> modes, distance, dX, energy;
  std::vector<std::string> motion;

  explicit Levels(const Table& shares) : basis(shares.texts("basis").front()) {
    for (std::size_t i = 0; i < shares.rows(); ++i) {
      if (shares.texts("basis")[i] != basis) continue;
      modes.push_back(shares.numbers("modes")[i]);
      distance.push_back(shares.numbers("wasserstein")[i]);
      dX.push_back(shares.numbers("dX")[i]);
      energy.push_back(shares.numbers("energy")[i]);
      motion.push_back(shares.texts("motion")[i]);
    }
  }
  [[nodiscard]] std::optional<std::size_t> of(double count) const {
    const auto found = std::ranges::find(modes, count);
    if (found == modes.end()) return std::nullopt;
    return static_cast<std::size_t>(found - modes.begin());
  }
  /// The fewest modes from which on all are within the scatter of the full model.
  [[nodiscard]] std::optional<std::size_t> first_within(double noise) const {
    std::optional<std::size_t> first;
    for (std::size_t i = modes.size(); i-- > 0 && distance[i] <= kScatter * noise;) first = i;
    return first;
  }
};

/// Where both are decided: the speeds at which motion and period agree, and stretches where they do not.
std::string where_text(const StoreReader& store, const char*& tone) {
  const Table full = results::load_table(store, "sweep/full/values");
  const Table reduced = results::load_table(store, "sweep/reduced/values");
  const std::string label = store.text("sweep/full/label");
  std::vector<std::pair<double, double>> apart;
  std::size_t same = 0, decided = 0;
  bool last_apart = false;
  for (std::size_t i = 0; i < full.rows(); ++i) {
    const std::string &a = full.texts("motion")[i], &b = reduced.texts("motion")[i];
    const bool known = a != "undecided" && b != "undecided" && a != "failed" && b != "failed";
    const bool agree = a == b && (a != "periodic" || full.numbers("period")[i] == reduced.numbers("period")[i]);
    decided += known ? 1 : 0;
    same += known && agree ? 1 : 0;
    const double speed = full.numbers("parameter")[i];
    if (known && !agree && !last_apart) apart.emplace_back(speed, speed);
    if (known && !agree) apart.back().second = speed;
    last_apart = known && !agree;
  }
  if (decided == 0) {
    tone = "poor";
    return "At none of the speeds are both motions decided: see the bifurcation diagram.";
  }
  const double share = 100.0 * static_cast<double>(same) / static_cast<double>(decided);
  tone = share >= 99.0 ? "good" : share >= 90.0 ? "fair" : "poor";
  std::string text = fmt::format(
      "{}: the same kind of motion and period at {:.1f} % of the {} values where both are "
      "decided ({} of {} are not).",
      label, share, decided, full.rows() - decided, full.rows());
  constexpr std::size_t kTold = 4;
  for (std::size_t i = 0; i < std::min(kTold, apart.size()); ++i) {
    const auto [from, to] = apart[i];
    text += i == 0 ? " They differ at " : ", ";
    text += from == to ? fmt::format("{:g}", from) : fmt::format("{:g} to {:g}", from, to);
  }
  if (apart.size() > kTold) text += fmt::format(" and {} more stretches", apart.size() - kTold);
  return apart.empty() ? text : text + ".";
}

Json trust(const Levels& levels, const StoreReader& store) {
  const double chosen = static_cast<double>(store.integer("validation/chosen_modes"));
  const double noise = store.number("validation/full/noise_wasserstein");
  const double speed = store.number("validation/full/speed");
  const auto row = levels.of(chosen);
  if (!row || !std::isfinite(levels.distance[*row])) {
    return answer("Is the reduced model to be trusted?",
                  fmt::format("With {} {}s nothing can be said: it gave no settled motion.", chosen, levels.basis),
                  "poor");
  }
  const auto enough = levels.first_within(noise);
  const double distance = levels.distance[*row];
  const bool within = distance <= kScatter * noise;
  std::string text = fmt::format(
      "{}: with {} {}s, which hold {:.2f} % of the energy, it settles to {} motion at V = {:g}; its slip states lie "
      "{:.3g} "
      "from the full model's, where two full runs lie {:.3g} apart.",
      within ? "Yes" : "In part", chosen, levels.basis, levels.energy[*row], levels.motion[*row], speed, distance,
      noise);
  if (!within && enough)
    text += fmt::format(" From {} modes on it is within {:g} times that scatter.", levels.modes[*enough], kScatter);
  if (!enough) text += " No number of modes that was tried stays within the scatter of the full model.";
  return answer("Is the reduced model to be trusted?", std::move(text), within ? "good" : enough ? "fair" : "poor");
}

Json saving(const StoreReader& store) {
  const double full = store.number("validation/cost/full_cpu"), reduced = store.number("validation/cost/reduced_cpu");
  const double gain = full / reduced;
  return answer(
      "What does it save?",
      fmt::format("One run of {:g} time units takes {:.3g} ms in full and {:.3g} ms reduced, of processor time: "
                  "{}.",
                  store.number("validation/cost/duration"), 1e3 * full, 1e3 * reduced,
                  gain > 1.05   ? fmt::format("{:.3g} times faster", gain)
                  : gain < 0.95 ? fmt::format("{:.3g} times slower, it saves nothing at this size", 1.0 / gain)
                                : std::string("no difference at this size")),
      gain > kPays ? "good" : "fair");
}

Json accuracy(const Levels& levels, const StoreReader& store) {
  const Table orbits = results::load_table(store, "validation/orbits");
  const double chosen = static_cast<double>(store.integer("validation/chosen_modes"));
  std::string text;
  if (const auto row = levels.of(chosen))
    text = fmt::format("From shared starts ΔX is {:.3g} % over the horizon.", levels.dX[*row]);
  double worst = 0.0;
  std::size_t alike = 0, all = 0;
  for (std::size_t i = 0; i < orbits.rows(); ++i) {
    if (orbits.texts("basis")[i] != levels.basis || orbits.numbers("modes")[i] != chosen) continue;
    ++all;
    const double dX = orbits.numbers("dX")[i];
    if (!std::isfinite(dX)) continue;
    ++alike;
    worst = std::max(worst, dX);
  }
  if (alike > 0)
    text += fmt::format(
        " On periodic orbits ΔX is at most {:.3g} % over one period, at {} of {} speeds where the periods "
        "are the same.",
        worst, alike, all);
  else if (all > 0)
    text += fmt::format(" At none of {} speeds has it the full model's periodic orbit.", all);
  return answer("How accurate is it?", std::move(text),
                all > 0 && alike == all && worst <= kAccurate ? "good" : "fair");
}

/// Reduced models under a shaker or a force: the smallest that lies as near as two full sweeps do, and the nearest of
/// all.
struct DrivenModels {
  Table models;
  double noise;
  std::optional<std::size_t> smallest = {}, nearest = {};

  explicit DrivenModels(const StoreReader& validation)
      : models(results::load_table(validation, "shaken_validation/agreement")),
        noise(validation.number("shaken_validation/noise")) {
    const auto& distance = models.numbers("mean_distance");
    const auto& modes = models.numbers("modes");
    for (std::size_t i = 0; i < models.rows(); ++i) {
      if (!std::isfinite(distance[i])) continue;
      if (!nearest || distance[i] < distance[*nearest]) nearest = i;
      if (distance[i] <= kScatter * noise && (!smallest || modes[i] < modes[*smallest])) smallest = i;
    }
  }
  /// Where any gave a settled motion: the one that is spoken of.
  [[nodiscard]] std::size_t told() const { return smallest.value_or(*nearest); }
};

}  // namespace

std::string model_text(const scene::Scene& scene) {
  std::string contacts;
  for (const scene::ContactSpec& contact : scene.contacts) {
    const auto& joint = contact.joint;
    if (joint && joint->element > 0) continue;
    contacts += fmt::format("; {} at {} ({})", joint ? joint->name : contact.name, scene::to_string(contact.at),
                            joint ? friction::Iwan::word : friction::law_word(contact.law));
  }
  return fmt::format("{}, {}{}.", structure_text(scene), drive_text(scene), contacts);
}

Json belt_answers(const StoreReader& validation) {
  const Levels levels(results::load_table(validation, "validation/shares"));
  Json out = Json::array();
  out.push_back(trust(levels, validation));
  if (validation.has("sweep/reduced")) {
    const char* tone = "fair";
    std::string text = where_text(validation, tone);
    out.push_back(answer("Where?", std::move(text), tone));
  }
  if (validation.has("validation/cost")) out.push_back(saving(validation));
  Json last = accuracy(levels, validation);
  if (!last["answer"].get_ref<const std::string&>().empty()) out.push_back(std::move(last));
  return out;
}

std::optional<NamedModel> told_of_driven(const StoreReader& validation) {
  const DrivenModels found(validation);
  if (!found.nearest) return std::nullopt;
  return NamedModel{found.models.texts("basis")[found.told()],
                    static_cast<Eigen::Index>(found.models.numbers("modes")[found.told()])};
}

Json driven_answers(const StoreReader& validation) {
  const DrivenModels found(validation);
  const Table& models = found.models;
  const std::optional<std::size_t>&smallest = found.smallest, &nearest = found.nearest;
  const auto& distance = models.numbers("mean_distance");
  const auto& modes = models.numbers("modes");
  constexpr const char* kTrust = "Are reduced models to be trusted?";
  if (!nearest) return Json::array({answer(kTrust, "None gave a settled motion.", "poor")});
  const std::size_t told = found.told();
  const auto model_name = [&](std::size_t i) {
    return fmt::format("{} {} of {}", modes[i], modes[i] == 1.0 ? "mode" : "modes", models.texts("basis")[i]);
  };
  Json out = Json::array();
  out.push_back(answer(
      kTrust,
      fmt::format(
          "{} {}: section points lie {:.3g} from the full model's, in units of its rms, where two full sweeps lie "
          "{:.3g} apart; the same kind of motion at {:.3g} % of the values. Nearest of all that were tried: {}, "
          "{:.3g}.",
          smallest ? "Yes, from" : "Not within the scatter of two full sweeps. Nearest:", model_name(told),
          distance[told], found.noise, 100.0 * models.numbers("same_label")[told], model_name(*nearest),
          distance[*nearest]),
      smallest ? "good" : "fair"));
  if (!validation.has("shaken_validation/full_cpu")) return out;
  const double full = validation.number("shaken_validation/full_cpu"), reduced = models.numbers("cpu")[told];
  if (!std::isfinite(full / reduced)) return out;
  out.push_back(
      answer("What does it save?",
             fmt::format("The timed run takes {:.3g} s in full and {:.3g} s with {}, of processor time: {:.3g} "
                         "times {}.",
                         full, reduced, model_name(told), std::max(full / reduced, reduced / full),
                         full > reduced ? "faster" : "slower"),
             full > 1.05 * reduced ? "good" : "fair"));
  return out;
}

}  // namespace slipmode::report
