#pragma once

#include <slipmode/diagnostics/series/findings.hpp>
#include <slipmode/results/series_input.hpp>
#include <slipmode/results/store.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

inline constexpr const char* kDiagnosisGroup = "diagnosis";

/// Name of something in that group.
[[nodiscard]] inline std::string diagnosis_path(const std::string& name) {
  return std::string(kDiagnosisGroup) + "/" + name;
}

/// Writes group `diagnosis`: the record, every number, every curve. Exponents of curves are in nats, information in
/// bits; the table `diagnosis/findings` is in the units of `findings`.
void save(StoreWriter& store, const diagnostics::SeriesStudy& study, const SeriesInput& input,
          const std::vector<diagnostics::Finding>& findings);

}  // namespace slipmode::results
