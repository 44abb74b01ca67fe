#pragma once

#include "cli/session.hpp"

#include <string>

namespace slipmode::cli {

/// Writes scripts to session.slurm that compute a study's shards as a job array under Slurm and join them afterwards:
/// `array.sh`, `merge.sh`, and `submit.sh`, which submits both. Times and memory come from one piece of the study,
/// which is computed for it.
/// @param output  of the study
/// @throws InvalidInput  for more shards than pieces, a study of one piece, --shard beside it, a folder that cannot be
///                       written
[[nodiscard]] Report write_slurm(const Session& session, const std::string& output);

}  // namespace slipmode::cli
