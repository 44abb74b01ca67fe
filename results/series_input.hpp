#pragma once

#include <slipmode/diagnostics/series/series.hpp>

#include <optional>
#include <string>

namespace slipmode::results {

/// Which part of which record.
struct SeriesRequest {
  std::string input;               ///< FILE or FILE:SERIES
  std::string time;                ///< column or dataset with the instants; empty: the one called time
  double interval = 0.0;           ///< > 0: between samples, for a file without instants
  std::optional<double> from, to;  ///< stretch kept, by the file's instants
  Eigen::Index every = 1;          ///< keeps every so many-th sample
  Eigen::Index member = 1;         ///< of an ensemble, from 1
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
[[nodiscard]] SeriesInput read_series(const SeriesRequest& request);

}  // namespace slipmode::results
