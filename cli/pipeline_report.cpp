#include "cli/pipeline_report.hpp"
#include <slipmode/results/table.hpp>
#include <slipmode/results/validation_store.hpp>
#include <slipmode/scene/driven.hpp>
#include "cli/modes_report.hpp"
#include "cli/text_table.hpp"
#include "cli/validation_report.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::cli {
namespace {

using studies::PipelineResult;

Eigen::VectorXd hertz(const PipelineResult& result) {
  constexpr Eigen::Index kShown = 6;
  return result.slipping.head(std::min(kShown, result.slipping.size())) / (2.0 * std::numbers::pi);
}

Json ensemble_json(const PipelineResult& result) {
  Json failures = Json::array();
  for (const auto& member : result.ensemble->members) {
    if (!member.failure.empty()) failures.push_back(member.failure);
  }
  return {{"runs", result.ensemble->members.size()},          {"snapshots", result.snapshots},
          {"steps", result.ensemble->total().steps},          {"certified", result.ensemble->total().certified},
          {"audit_residual", result.ensemble->worst_audit()}, {"failures", failures}};
}

std::string frequencies(const Eigen::VectorXd& omega) {
  constexpr Eigen::Index kShown = 5;
  std::string out;
  for (Eigen::Index k = 0; k < std::min(kShown, omega.size()); ++k) out += fmt::format(" {:.5g}", omega[k]);
  return omega.size() > kShown ? out + " ..." : out;
}

std::string payback(double runs) {
  if (std::isinf(runs)) return "never paid back: the reduced model is not faster at this size";
  return fmt::format("paid back after {:.0f} such runs", std::ceil(runs));
}

Json left_out_json(const std::vector<studies::LeftOut>& left_out) {
  Json out = Json::array();
  for (const studies::LeftOut& part : left_out) out.push_back({{"what", part.what}, {"brought_by", part.brought_by}});
  return out;
}

std::string left_out_text(const std::vector<studies::LeftOut>& left_out) {
  std::string out;
  for (const studies::LeftOut& part : left_out) {
    out += fmt::format("  left out: {}; the table {} in the scene brings it, with defaults if empty\n", part.what,
                       part.brought_by);
  }
  return out;
}

/// Frequencies and energies: a shaker's are told in Hz and with the shares of natural modes.
Json modes_json(const PipelineResult& result, bool shaken) {
  if (!shaken) {
    return {{"slipping_omega", results::values_of(result.slipping)},
            {"sticking_omega", results::values_of(result.sticking)}};
  }
  return {{"slipping_hz", results::values_of(hertz(result))}};
}

Json pod_json(const PipelineResult& result) {
  if (result.shaken_modes) return json_of(*result.shaken_modes);
  return {{"rank", result.pod->rank},
          {"shares", results::values_of(result.pod->shares)},
          {"chosen_modes", result.chosen},
          {"chosen_energy", result.captured}};
}

Json validation_json(const PipelineResult& result) {
  if (result.driven_validation) return to_json(*result.driven_validation);
  Json out = to_json(*result.validation);
  if (result.validation->cost) {
    out["cost"]["basis_wall_s"] = result.basis_wall();
    out["cost"]["break_even_runs"] = result.validation->cost->break_even(result.basis_wall());
  }
  return out;
}

std::string modes_text(const PipelineResult& result, bool shaken) {
  if (shaken) {
    std::string out = "  frequencies f [Hz], slipping:";
    for (const double f : hertz(result)) out += fmt::format(" {:.5g}", f);
    return out + '\n';
  }
  std::string out = fmt::format("  frequencies ω, slipping:{}\n", frequencies(result.slipping));
  if (result.sticking.size() > 0) out += fmt::format("  frequencies ω, sticking:{}\n", frequencies(result.sticking));
  return out;
}

std::string validation_text(const PipelineResult& result, const scene::Scene& scene) {
  if (result.driven_validation) return '\n' + summary_text(*result.driven_validation, scene);
  std::string out = '\n' + summary_text(*result.validation, results::Units::of(scene.units));
  if (!result.validation->cost) return out;
  return out + fmt::format("  the basis took {:.2f} s, {}\n", result.basis_wall(),
                           payback(result.validation->cost->break_even(result.basis_wall())));
}

}  // namespace

Json to_json(const PipelineResult& result, const scene::Scene& scene) {
  Json out = {{"verb", "run"}, {"title", scene.title}, {"units", scene.units}};
  out["modes"] = modes_json(result, is_shaken(scene));
  if (result.ensemble) out["ensemble"] = ensemble_json(result);
  if (result.pod || result.shaken_modes) out["pod"] = pod_json(result);
  if (result.shaken_modes)
    out["reduction"] = {{"basis", scene::to_string(scene.reduction.basis)}, {"modes", result.chosen}};
  const bool validated = result.validation || result.driven_validation;
  if (validated) out["validation"] = validation_json(result);
  if (!result.left_out.empty()) out["left_out"] = left_out_json(result.left_out);
  for (const auto& stage : result.stages) out["seconds"][stage.name] = stage.wall;
  if (result.validation) out["seconds"]["validate_sweep"] = result.validation->sweep_wall;  // part of validate
  out["files"] = result.files;
  out["figures"] = result.figures;
  return out;
}

std::string summary_text(const PipelineResult& result, const scene::Scene& scene) {
  std::string out = scene.name() + "\n" + modes_text(result, is_shaken(scene));
  if (result.ensemble) {
    out += fmt::format("  ensemble: {} runs, {} snapshots, {}, largest energy residual {:.1e}\n",
                       result.ensemble->members.size(), result.snapshots, certificate(result.ensemble->total()),
                       result.ensemble->worst_audit());
  }
  if (result.pod) {
    out += fmt::format("  reduction: {} {}s hold {:.2f} % of the energy\n", result.chosen, result.reduced,
                       100.0 * result.captured);
  }
  if (result.shaken_modes) out += '\n' + text_of(*result.shaken_modes);
  if (result.validation || result.driven_validation) out += validation_text(result, scene);
  out += left_out_text(result.left_out) + '\n';
  std::string times;
  for (const auto& stage : result.stages) {
    times += fmt::format("{}{} {:.2f} s", times.empty() ? "" : ", ", stage.name, stage.wall);
  }
  return out + "  " + times + '\n';
}

}  // namespace slipmode::cli
