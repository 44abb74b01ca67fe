#pragma once

#include <slipmode/results/store.hpp>
#include "report/internal/json.hpp"

namespace slipmode::report {

/// What a result file says, whatever its kind: name, kind, provenance, energy audit, its tables, its figures.
/// @param with_figures  false where another file shows the same ones
[[nodiscard]] Json file_json(const results::StoreReader& store, bool with_figures);

/// A table, column by column. @throws InvalidInput  as results::load_table
[[nodiscard]] Json table_json(const results::StoreReader& store, const std::string& group);

}  // namespace slipmode::report
