#pragma once

#include "bench/library_cases.hpp"
#include "bench/machine.hpp"

#include <optional>
#include <string>
#include <vector>

namespace slipmode::bench {

/// One measured case of one run, a line of the file:
///
///     date,commit,processor,kernels,case,ms,audit_on_off,ratio_cvode,ratio_dopri5,error,quiet
struct HistoryRow {
  std::string date, commit, processor, kernels;
  Timed timed;
  std::string quiet;  ///< "quiet" or why not
};

/// Cases of all runs so far, on file.
class History {
 public:
  /// @throws std::runtime_error  for a file that is not of this form; one that is missing counts as empty
  explicit History(std::string path);

  /// Adds a line at the end of the file, which is created with a heading if need be.
  void append(const Machine& machine, const Timed& timed, const Quietness& quietness) const;

  /// How the case compares with the last quiet run before this one on the same processor with the same kernels.
  [[nodiscard]] std::string change(const Machine& machine, const Timed& timed, const Quietness& quietness) const;

 private:
  std::string path_;
  std::vector<HistoryRow> before_;  // what the file held when this run began
};

}  // namespace slipmode::bench
