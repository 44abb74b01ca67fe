#pragma once

#include <slipmode/diagnostics/series/findings.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/results/series_input.hpp>

#include <memory>
#include <string>

namespace slipmode::results {

inline constexpr const char* kDiagnosisGroup = "diagnosis";

/// Name of something in that group.
[[nodiscard]] inline std::string diagnosis_path(const std::string& name) {
  return std::string(kDiagnosisGroup) + "/" + name;
}

/// Group `diagnosis`: the record, every number, every curve. Exponents of curves are in nats, information in bits.
/// @param bits  the table `diagnosis/findings` is in bits, else in nats
[[nodiscard]] Content content_of(std::shared_ptr<const diagnostics::SeriesStudy> study, SeriesInput input, bool bits);

}  // namespace slipmode::results
