#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace slipmode::results {

class StoreReader;

/// What a result file holds. Every file says so.
enum class FileKind : std::uint8_t {
  kTrajectory,
  kEnsemble,
  kPod,
  kBasis,
  kReduced,
  kModes,
  kValidation,
  kSweep,
  kExponents,
  kExponentSweep,
  kVerdict,
  kSeries,
  kReturns,
  kOrbit,
  kBranches,
  kCurves,
  kMap,
  kStrobe,
  kBasins,
  kSkeleton,
  kSpectrum,
  kBalance,
  kTrade,
};

struct FileKindWords {
  const char* word;     ///< attribute `kind` of the file
  const char* noun;     ///< as messages call it
  const char* meaning;  ///< attribute `description` of the file
  const char* made_by;  ///< what makes one
};

/// In the order of the enumeration.
inline constexpr std::array kFileKinds{
    FileKindWords{"trajectory", "a trajectory", "one motion with its events", "slipmode simulate --single"},
    FileKindWords{"ensemble", "an ensemble", "snapshots of several motions", "slipmode simulate"},
    FileKindWords{"pod", "a POD", "proper orthogonal modes of a motion", "slipmode pod"},
    FileKindWords{"basis", "a basis", "vectors to reduce a model by", "results::save of a pod::Basis"},
    FileKindWords{"reduced-model", "a reduced model", "a reduced model and its basis", "slipmode reduce"},
    FileKindWords{"modes", "natural modes", "natural modes, contacts slipping and held", "slipmode modes"},
    FileKindWords{"validation", "a validation", "reduced models compared with the full one", "slipmode validate"},
    FileKindWords{"sweep", "a sweep", "settled motions over a key", "slipmode sweep"},
    FileKindWords{"exponents", "Lyapunov exponents", "Lyapunov exponents of models", "slipmode diagnose SCENE"},
    FileKindWords{"exponent-sweep", "exponents over a key", "leading Lyapunov exponents over a key",
                  "slipmode diagnose SCENE --over"},
    FileKindWords{"verdict", "a verdict", "exponents, dimensions and statistics of models side by side",
                  "slipmode diagnose SCENE --verdict"},
    FileKindWords{"series", "a record's diagnosis", "what a record is, with every curve", "slipmode diagnose RECORD"},
    FileKindWords{"returns", "close returns", "close returns of a record", "slipmode orbit returns"},
    FileKindWords{"orbit", "an orbit", "a periodic orbit and one period of it", "slipmode orbit find"},
    FileKindWords{"branches", "branches of orbits", "periodic orbits over a key", "slipmode orbit continue"},
    FileKindWords{"curves", "curves of special points", "special points of periodic orbits over two keys",
                  "slipmode orbit continue --along"},
    FileKindWords{"map", "a map", "periodic orbits over two keys", "slipmode orbit map"},
    FileKindWords{"strobe", "a stroboscopic map", "motion seen once per period over a key", "slipmode orbit map"},
    FileKindWords{"basins", "basins of attraction", "which attractor each start of a plane ends on",
                  "slipmode orbit basins"},
    FileKindWords{"skeleton", "a skeleton", "unstable periodic orbits in an attractor", "slipmode orbit skeleton"},
    FileKindWords{"spectrum", "a spectrum", "Fourier coefficients of a periodic orbit", "slipmode orbit spectrum"},
    FileKindWords{"balance", "a balance", "a harmonic balance and the orbit behind it",
                  "slipmode orbit find --by balance"},
    FileKindWords{"trade", "a trade study", "errors and costs of configurations of a scene", "slipmode trade"},
};

[[nodiscard]] constexpr const FileKindWords& words_of(FileKind kind) {
  return kFileKinds[static_cast<std::size_t>(kind)];
}

/// What a file says it is. Of files of earlier versions, which do not say, it is told by what they hold; nothing for
/// files of other programs.
[[nodiscard]] std::optional<FileKind> kind_of(const StoreReader& store);

/// The file's kind, one of those expected.
/// @throws InvalidInput  for another: "x.h5 holds a sweep; expected a POD or an ensemble; 'slipmode pod' makes one"
FileKind require_kind(const StoreReader& store, std::span<const FileKind> expected);

}  // namespace slipmode::results
