#pragma once

#include <slipmode/results/journal.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/trade/orbit_methods.hpp>
#include <slipmode/trade/study.hpp>

namespace slipmode::results {

inline constexpr const char* kTradeGroup = "trade";

/// Lets a study keep the errors it finds in a journal and take over those it already holds. The journal must outlive
/// the study.
void keep_in(Journal& journal, trade::StudyOptions& out_options);

/// Writes the group `trade`: a table `candidates`, the reference, its scatter and how long everything ran.
void store_study(StoreWriter& writer, const trade::Study& study, const scene::Scene& scene);

/// Writes a table `orbits` into it: ways to the periodic orbit, shooting first.
void store_orbits(StoreWriter& writer, const trade::OrbitStudy& study);

}  // namespace slipmode::results
