#include "cli/times_report.hpp"

#include <slipmode/core/terminal.hpp>
#include <slipmode/scene/own_times.hpp>

#include <fmt/format.h>

namespace slipmode::cli {

void tell_chosen_times(const scene::Scene& scene, const std::vector<std::string>& names, Report& out_report) {
  constexpr std::size_t kColumns = 80;
  const scene::ChosenTimes chosen = scene::chosen_times(scene, names);
  if (chosen.times.empty()) return;
  Json values = Json::object();
  std::string text = fmt::format("Chosen by {}, {:.4g}{}:", chosen.of, chosen.period, scene.units == "SI" ? " s" : "");
  for (const auto& time : chosen.times) {
    values[time.key] = time.value;
    text += fmt::format("{} {} {:g}", &time == &chosen.times.front() ? "" : ",", time.key, time.value);
  }
  out_report.data["chosen_times"] = {{"by", chosen.of}, {"period", chosen.period}, {"values", values}};
  out_report.text += wrapped(text, kColumns) + "\n";
}

void tell_without_slips(const scene::Scene& scene, Report& out_report) {
  if (scene.drive.belt() == nullptr || has_sticking_law(scene)) return;
  out_report.text +=
      "No law of this scene sticks: without slips motions stay undecided here; 'orbit\n"
      "find' tells a period, 'diagnose' whether a motion is chaotic\n";
}

void tell_alike_runs(const scene::Scene& scene, Report& out_report) {
  if (!has_section(scene, "ensemble") || scene.ensemble.members < 2 || scene.ensemble.spread > 0.0) return;
  out_report.text += fmt::format("All {} runs of the ensemble start alike, as ensemble.spread = 0: one would do\n",
                                 scene.ensemble.members);
}

}  // namespace slipmode::cli
