#include <slipmode/results/table.hpp>
#include <slipmode/results/validation_store.hpp>
#include "cli/json_values.hpp"
#include "cli/pipeline.hpp"
#include "cli/text_table.hpp"
#include "cli/validation_report.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::cli {
namespace {

Json ensemble_json(const PipelineResult& result) {
  Json failures = Json::array();
  for (const auto& member : result.ensemble->members) {
    if (!member.failure.empty()) failures.push_back(member.failure);
  }
  return {{"runs", result.ensemble->members.size()},
          {"snapshots", result.snapshots},
          {"audit_residual", worst_audit(*result.ensemble)},
          {"failures", failures}};
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

}  // namespace

bool gathers_ensemble(const scene::Scene& scene) {
  return has_section(scene, "ensemble") || has_section(scene, "reduction") || has_section(scene, "validation");
}

std::vector<LeftOut> left_out_of(const scene::Scene& scene) {
  std::vector<LeftOut> out;
  if (!gathers_ensemble(scene)) out.push_back({"ensemble, proper orthogonal modes and reduced models", "[ensemble]"});
  if (!has_section(scene, "validation"))
    out.push_back({"comparison of reduced models with the full one", "[validation]"});
  return out;
}

Json to_json(const std::vector<LeftOut>& left_out) {
  Json out = Json::array();
  for (const LeftOut& part : left_out) out.push_back({{"what", part.what}, {"brought_by", part.brought_by}});
  return out;
}

std::string left_out_text(const std::vector<LeftOut>& left_out) {
  std::string out;
  for (const LeftOut& part : left_out) {
    out += fmt::format("  left out: {}; the table {} in the scene brings it, with defaults if empty\n", part.what,
                       part.brought_by);
  }
  return out;
}

Json to_json(const PipelineResult& result, const scene::Scene& scene) {
  Json out = {{"verb", "run"}, {"title", scene.title}, {"units", scene.units}};
  out["modes"] = {{"slipping_omega", results::values_of(result.slipping)},
                  {"sticking_omega", results::values_of(result.sticking)}};
  if (result.ensemble) out["ensemble"] = ensemble_json(result);
  if (result.pod) {
    out["pod"] = {{"rank", result.pod->rank},
                  {"shares", results::values_of(result.pod->shares)},
                  {"chosen_modes", result.chosen},
                  {"chosen_energy", result.pod->shares.head(result.chosen).sum()}};
  }
  if (result.validation) {
    out["validation"] = to_json(*result.validation);
    if (result.validation->cost) {
      out["validation"]["cost"]["basis_wall_s"] = result.basis_wall();
      out["validation"]["cost"]["break_even_runs"] = result.validation->cost->break_even(result.basis_wall());
    }
  }
  if (!result.left_out.empty()) out["left_out"] = to_json(result.left_out);
  for (const auto& stage : result.stages) out["seconds"][stage.name] = stage.wall;
  if (result.validation) out["seconds"]["validate_sweep"] = result.validation->sweep_wall;  // part of validate
  out["files"] = result.files;
  out["figures"] = result.figures;
  return out;
}

std::string summary_text(const PipelineResult& result, const scene::Scene& scene) {
  std::string out = scene.title + "\n";
  out += fmt::format("  frequencies ω, slipping:{}\n", frequencies(result.slipping));
  if (result.sticking.size() > 0) out += fmt::format("  frequencies ω, sticking:{}\n", frequencies(result.sticking));
  if (result.ensemble) {
    out += fmt::format("  ensemble: {} runs, {} snapshots, largest energy residual {:.1e}\n",
                       result.ensemble->members.size(), result.snapshots, worst_audit(*result.ensemble));
  }
  if (result.pod) {
    out += fmt::format("  reduction: {} of {} modes hold {:.2f} % of the energy\n", result.chosen,
                       result.pod->basis.modes(), 100.0 * result.pod->shares.head(result.chosen).sum());
  }
  if (result.validation) {
    out += '\n' + summary_text(*result.validation);
    if (result.validation->cost) {
      out += fmt::format("  the basis took {:.2f} s, {}\n", result.basis_wall(),
                         payback(result.validation->cost->break_even(result.basis_wall())));
    }
  }
  out += left_out_text(result.left_out) + '\n';
  std::string times;
  for (const auto& stage : result.stages) {
    times += fmt::format("{}{} {:.2f} s", times.empty() ? "" : ", ", stage.name, stage.wall);
  }
  return out + "  " + times + '\n';
}

}  // namespace slipmode::cli
