#include "cli/session.hpp"

#include <unistd.h>

#include <fmt/format.h>
#include <toml++/toml.h>
#include <algorithm>
#include <cerrno>
#include <cstring>

namespace slipmode::cli {

namespace fs = std::filesystem;

ParallelOptions Session::parallel(ProgressLine& line) const {
  return {.threads = threads, .stop = stop, .progress = line.callback()};
}

scene::Scene Session::load(const fs::path& path) const {
  std::vector<std::string> all = overrides;
  if (seed) all.push_back(fmt::format("ensemble.seed={}", *seed));
  return scene::load_scene(path, all);
}

void Session::check_interrupt() const {
  if (stop != nullptr && stop->load()) throw Interrupted();
}

void require_writable(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (fs::is_directory(file)) {
    throw InvalidInput(fmt::format("output '{}' is a folder; give the name of a file", file.string()));
  }
  if (!fs::is_directory(folder)) {
    throw InvalidInput(fmt::format("cannot write '{}': there is no folder '{}'; create it or choose another with -o",
                                   file.string(), folder.string()));
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw InvalidInput(fmt::format("cannot write '{}': folder '{}': {}; choose another with -o", file.string(),
                                   folder.string(), std::strerror(errno)));
  }
}

std::string describe(const NumericalFailure& failure) {
  constexpr Eigen::Index kShown = 20;
  std::string text =
      fmt::format("{}\n  time {:.17g}, residual {:.6g}\n  state", failure.what(), failure.time, failure.residual);
  for (Eigen::Index i = 0; i < std::min(failure.state.size(), kShown); ++i) {
    text += fmt::format(" {:.17g}", failure.state[i]);
  }
  if (failure.state.size() == 0) text += " not known";
  if (failure.state.size() > kShown) text += fmt::format(" ... ({} values)", failure.state.size());
  return text;
}

bool has_section(const scene::Scene& scene, const std::string& name) {
  const toml::table written = toml::parse(scene.source.text);
  if (written.contains(name)) return true;
  for (const std::string& override : scene.source.overrides) {
    if (override.starts_with("ensemble.seed=")) continue;
    if (override.starts_with(name + ".") || override.starts_with(name + "=")) return true;
  }
  return false;
}

}  // namespace slipmode::cli
