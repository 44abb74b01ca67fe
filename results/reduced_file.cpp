#include <slipmode/results/reduced_file.hpp>

#include <slipmode/results/records.hpp>

#include <array>
#include <string_view>

namespace slipmode::results {

std::optional<std::string> reduced_file(const std::string& model) {
  constexpr std::string_view kPrefix = "rom:";
  if (!model.starts_with(kPrefix)) return std::nullopt;
  return model.substr(kPrefix.size());
}

pod::Basis reduced_basis(const StoreReader& store, Eigen::Index size) {
  require_kind(store, std::array{FileKind::kReduced});
  return load_basis(store, std::string(kReducedGroup) + "/basis", size);
}

}  // namespace slipmode::results
