#include "cli/pipeline_figures.hpp"

#include <slipmode/core/parallel.hpp>
#include "cli/file_figures.hpp"

#include <algorithm>
#include <utility>

namespace slipmode::cli {

std::vector<std::string> save_figures_of(const Session& session, const std::filesystem::path& folder,
                                         const std::vector<std::string>& files,
                                         const std::vector<std::string>& skipped) {
  std::vector<std::pair<std::string, figures::Figure>> drawn;
  for (const std::string& name : files) {
    if (std::find(skipped.begin(), skipped.end(), name) != skipped.end()) continue;
    const results::StoreReader store(folder / name);
    for (const figures::FileFigure& figure : figures_of(store)) drawn.emplace_back(figure.name, figure.draw());
  }
  std::vector<std::string> names;
  for (const auto& entry : drawn) {
    for (const char* extension : {".svg", ".png"}) names.push_back(entry.first + extension);
  }
  const ParallelOptions parallel{.threads = session.threads, .stop = session.stop, .progress = {}};
  rethrow_first(parallel_for(names.size(), parallel,
                             [&](std::size_t i) { figures::save(drawn[i / 2].second, {folder / names[i]}); }));
  return names;
}

}  // namespace slipmode::cli
