#include <slipmode/results/file_kind.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/store.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <string>
#include <utility>

namespace slipmode::results {
namespace {

/// Groups that tell files without a kind apart, the first one found: a few kinds hold groups of others too.
constexpr std::pair<const char*, FileKind> kMarks[] = {
    {"map", FileKind::kMap},
    {"strobe", FileKind::kStrobe},
    {"basins", FileKind::kBasins},
    {"skeleton", FileKind::kSkeleton},
    {"diagnosis", FileKind::kSeries},
    {"validation", FileKind::kValidation},
    {"shaken_validation", FileKind::kValidation},
    {"verdict", FileKind::kVerdict},
    {"exponents/full", FileKind::kExponentSweep},
    {"exponents", FileKind::kExponents},
    {"spectrum", FileKind::kSpectrum},
    {"balance", FileKind::kBalance},
    {"trade", FileKind::kTrade},
    {"orbit", FileKind::kOrbit},
    {"branches", FileKind::kBranches},
    {"curves", FileKind::kCurves},
    {"returns", FileKind::kReturns},
    {"sweep", FileKind::kSweep},
    {"reduced", FileKind::kReduced},
    {"pod", FileKind::kPod},
    {"basis", FileKind::kBasis},
    {"ensemble", FileKind::kEnsemble},
    {"trajectory", FileKind::kTrajectory},
    {"modes", FileKind::kModes},
};

/// "a POD, an ensemble or a reduced model".
std::string one_of(std::span<const FileKind> kinds) {
  std::string text = words_of(kinds.front()).noun;
  for (std::size_t k = 1; k < kinds.size(); ++k) {
    text += fmt::format("{}{}", k + 1 < kinds.size() ? ", " : " or ", words_of(kinds[k]).noun);
  }
  return text;
}

}  // namespace

std::optional<FileKind> kind_of(const StoreReader& store) {
  const std::string word = store.attribute("kind");
  if (word.empty()) {
    for (const auto& [group, kind] : kMarks) {
      if (store.has(group)) return kind;
    }
    return std::nullopt;
  }
  const auto found = std::ranges::find(kFileKinds, word, &FileKindWords::word);
  if (found == kFileKinds.end()) return std::nullopt;
  return static_cast<FileKind>(found - kFileKinds.begin());
}

FileKind require_kind(const StoreReader& store, std::span<const FileKind> expected) {
  const std::optional<FileKind> found = kind_of(store);
  if (found && std::ranges::find(expected, *found) != expected.end()) return *found;
  const std::string word = store.attribute("kind");
  const std::string held = found          ? words_of(*found).noun
                           : word.empty() ? "no result of slipmode"
                                          : fmt::format("a '{}', unknown to this version", word);
  throw InvalidInput(fmt::format("'{}' holds {}; expected {}; '{}' makes one", store.path().string(), held,
                                 one_of(expected), words_of(expected.front()).made_by));
}

}  // namespace slipmode::results
