#pragma once

#include <slipmode/diagnostics/validation/verdict.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/results/units.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

inline constexpr const char* kExponentsGroup = "exponents";
inline constexpr const char* kVerdictGroup = "verdict";

/// A model's exponents, or why there are none.
struct ModelExponents {
  std::string name;
  diagnostics::LyapunovSpectrum spectrum;
  std::string failure;
};

/// Writes `exponents/<i>` for every model: values with errors, their history, rates per interval, balance of volumes.
void store_exponents(StoreWriter& writer, const std::vector<ModelExponents>& models, const Units& units);
/// Writes the table `verdict`, a row for every figure of every model.
void store_verdict(StoreWriter& writer, const diagnostics::VerdictTable& verdict, const Units& units);
/// The exponents of a table's models.
[[nodiscard]] std::vector<ModelExponents> exponents_of(const diagnostics::VerdictTable& verdict);

/// Leading exponents at one value of a swept key.
struct LeadingExponents {
  Eigen::VectorXd nats, error;  ///< [1/s], standard errors of them
  std::string ended = {};       ///< empty, or why measuring ended early
};
using ExponentPoint = SweptValue<LeadingExponents>;
using ExponentSink = SinkOf<LeadingExponents>;

/// A sink that keeps finished values in a journal and takes over those it already holds. The journal must outlive it.
[[nodiscard]] ExponentSink exponent_sink(Journal& journal);

/// Writes `group`: exponents and their errors over a key, one row per value. @param title  which model
void store_exponent_sweep(StoreWriter& writer, const std::string& group, const std::string& title,
                          const SweepAxis& axis, const Units& units, const std::vector<ExponentPoint>& points);

/// A line of the verdict.
struct VerdictRow {
  std::string name, unit;
  std::vector<diagnostics::Halved> values;  ///< one per model
};
[[nodiscard]] std::vector<VerdictRow> verdict_rows(const diagnostics::VerdictTable& verdict, double unit,
                                                   const std::string& unit_name);

}  // namespace slipmode::results
