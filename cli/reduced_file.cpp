#include "cli/reduced_file.hpp"

#include "scene/records.hpp"

#include <string_view>

namespace slipmode::cli {

std::optional<std::string> reduced_file(const std::string& model) {
  constexpr std::string_view kPrefix = "rom:";
  if (!model.starts_with(kPrefix)) return std::nullopt;
  return model.substr(kPrefix.size());
}

pod::Basis reduced_basis(const std::string& file, Eigen::Index size) {
  const scene::StoreReader store(file);
  if (!store.has(scene::kReducedGroup)) {
    store.fail(scene::kReducedGroup, "the file holds no reduced model; make one with 'slipmode reduce'");
  }
  return scene::load_basis(store, std::string(scene::kReducedGroup) + "/basis", size);
}

}  // namespace slipmode::cli
