#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/diagnostics/series/series.hpp>
#include <slipmode/results/store.hpp>

#include <optional>
#include <string>

namespace slipmode::results {

/// Which part of a record.
struct SeriesRequest {
  std::string time;  ///< column or dataset with the instants; empty: the one called time
  double interval = 0.0;
  std::optional<double> from, to;
  Eigen::Index every = 1, member = 1;

  static constexpr auto fields() {
    return std::tuple{optional("interval", &SeriesRequest::interval, "",
                               "between samples, for a record without instants; 1 for a map", kNonNegative),
                      optional("from", &SeriesRequest::from, "", "leaves out what is earlier"),
                      optional("to", &SeriesRequest::to, "", "leaves out what is later"),
                      optional("every", &SeriesRequest::every, "", "keeps every so many-th sample", kCount),
                      optional("member", &SeriesRequest::member, "", "of an ensemble, from 1", kCount)};
  }
};

/// A record with what is known about it beyond its samples.
struct SeriesInput {
  diagnostics::Series series;
  std::string what;           ///< "trajectory/v, column 1: velocity of q1, farthest from the contacts"
  std::string smoother;       ///< FILE:SERIES that contacts disturb least; empty: this one, or not known
  double drive_period = 0.0;  ///< of a shaker or a force; 0: none
  double start = 0.0;         ///< instant of the first sample
};

/// Reads a record from one of our HDF5 files, any other, or CSV with a header.
///
/// SERIES of HDF5 is a dataset, and its column from 1 or by the degree of freedom's name: `trajectory/v/3`, `v/3`,
/// `v/x3`, `sensors/6`, `snapshots/1`. Without it the velocity (of an ensemble the displacement) farthest from the
/// contacts is taken, as S4 section 3.2 does: most links away. SERIES of CSV is a column's name or number from 1.
/// @throws InvalidInput  for files that cannot be read, columns that are not there (naming those that are), instants
///                       that are not equally spaced, cells without a number in the stretch kept (naming the line)
/// @param input  FILE or FILE:SERIES
[[nodiscard]] SeriesInput read_series(const std::string& input, const SeriesRequest& request);
/// The same of a result in memory. @param series  empty: the one farthest from the contacts
[[nodiscard]] SeriesInput read_series(StoreReader store, const std::string& series, const SeriesRequest& request);
/// Of samples `interval` apart, or 1. @param name  as messages call it
[[nodiscard]] SeriesInput series_of(const Eigen::VectorXd& values, const std::string& name,
                                    const SeriesRequest& request);

}  // namespace slipmode::results
