#pragma once

#include <string>
#include <vector>

namespace slipmode::cli {

/// Something that a build has or lacks, as `slipmode --version` tells it.
struct Feature {
  std::string name;   ///< one word
  std::string value;  ///< what there is, or "none: " and why
};

/// What this build has. @throws InvalidInput  when SLIPMODE_KERNELS names vector loops that there are not
[[nodiscard]] std::vector<Feature> features();

/// Version, commit and compiler in one line, then a line per feature.
[[nodiscard]] std::string version_text();

/// Where `cmake --install`, and so the package, puts the scenes that ship.
[[nodiscard]] std::string dataset_folder();

}  // namespace slipmode::cli
