#include <slipmode/figures/file_figures.hpp>

#include <slipmode/figures/balance_figures.hpp>
#include <slipmode/figures/basins_figures.hpp>
#include <slipmode/figures/belt_figures.hpp>
#include <slipmode/figures/exponents_figures.hpp>
#include <slipmode/figures/map_figures.hpp>
#include <slipmode/figures/natural_mode_figures.hpp>
#include <slipmode/figures/orbit_figures.hpp>
#include <slipmode/figures/series_figures.hpp>
#include <slipmode/figures/shaken_figures.hpp>
#include <slipmode/figures/skeleton_figures.hpp>
#include <slipmode/figures/spectrum_figures.hpp>
#include <slipmode/figures/trade_figures.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/scene/driven.hpp>

#include <algorithm>
#include <utility>

namespace slipmode::figures {
namespace {

using results::FileKind;

/// Figures of a file that is known to be of a kind, the most telling first.
using FiguresOf = std::vector<FileFigure> (*)(const results::StoreReader&);

struct KindFigures {
  FileKind kind;
  FiguresOf figures;
  FiguresOf others = nullptr;                         ///< of scenes of which …
  bool (*has_others)(const scene::Scene&) = nullptr;  ///< … this is true
};

constexpr KindFigures kFigures[] = {
    {FileKind::kTrajectory, trajectory_figures_of, shaken_trajectory_figures_of, scene::is_shaken},
    {FileKind::kPod, belt_pod_figures_of, shaken_pod_figures_of, scene::is_shaken},
    {FileKind::kModes, natural_mode_figures_of},
    {FileKind::kReduced, belt_reduced_figures_of, shaken_reduced_figures_of, scene::is_shaken},
    {FileKind::kValidation, belt_validation_figures_of, driven_validation_figures_of, scene::is_driven},
    {FileKind::kSweep, belt_sweep_figures_of, driven_sweep_figures_of, scene::is_driven},
    {FileKind::kExponents, exponents_figures_of},
    {FileKind::kVerdict, exponents_figures_of},
    {FileKind::kExponentSweep, exponent_sweep_figures_of},
    {FileKind::kSeries, series_figures_of},
    {FileKind::kOrbit, orbit_figures_of},
    {FileKind::kBranches, branch_figures_of},
    {FileKind::kCurves, curve_figures_of},
    {FileKind::kMap, map_figures_of},
    {FileKind::kStrobe, strobe_figures_of},
    {FileKind::kBasins, basins_figures_of},
    {FileKind::kSkeleton, skeleton_figures_of},
    {FileKind::kSpectrum, spectrum_figures_of},
    {FileKind::kBalance, balance_figures_of},
    {FileKind::kTrade, trade_figures_of},
};

}  // namespace

std::vector<FileKind> drawn_kinds() {
  std::vector<FileKind> kinds;
  for (const KindFigures& drawn : kFigures) kinds.push_back(drawn.kind);
  return kinds;
}

std::vector<FileFigure> figures_of(const results::StoreReader& store) {
  const auto kind = results::kind_of(store);
  for (const KindFigures& drawn : kFigures) {
    if (drawn.kind != kind) continue;
    const bool others = drawn.others != nullptr && drawn.has_others(results::load_scene_of(store));
    return (others ? drawn.others : drawn.figures)(store);
  }
  return {};
}

std::vector<std::string> save_figures_of(const std::filesystem::path& folder, const std::vector<std::string>& files,
                                         const std::vector<std::string>& skipped, const ParallelOptions& parallel) {
  std::vector<std::pair<std::string, Figure>> drawn;
  for (const std::string& name : files) {
    if (std::find(skipped.begin(), skipped.end(), name) != skipped.end()) continue;
    const results::StoreReader store(folder / name);
    for (const FileFigure& figure : figures_of(store)) drawn.emplace_back(figure.name, figure.draw(store));
  }
  std::vector<std::string> names;
  for (const auto& entry : drawn) {
    for (const char* extension : {".svg", ".png"}) names.push_back(entry.first + extension);
  }
  rethrow_first(
      parallel_for(names.size(), parallel, [&](std::size_t i) { save(drawn[i / 2].second, {folder / names[i]}); }));
  return names;
}

}  // namespace slipmode::figures
