#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/core/parallel.hpp>
#include <slipmode/core/ranks.hpp>

#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slipmode {

/// Bad input of another rank, as RankFailure::rethrow() throws it: its words name what they are about.
class InvalidInputOfRank : public InvalidInput {
 public:
  using InvalidInput::InvalidInput;
};

/// Parcels between ranks that compute something in steps which all know: who sends is waited for by name. A rank that
/// waits sleeps, and notices when it is stopped; rank 0 also when another rank has failed. Between two ranks parcels
/// keep their order, not among three: rank 0 hears from all others that they wait no more before end_ranks() lets them
/// go.
class Exchange {
 public:
  /// @param ranks  outlives this
  /// @param stop   polled while waiting; nullptr: never stops
  Exchange(const Ranks& ranks, const StopFlag* stop);

  [[nodiscard]] int own() const { return ranks_.own; }
  [[nodiscard]] int count() const { return ranks_.count; }

  /// Returns at once.
  void send(int to, std::string_view bytes) const;
  void send(int to, std::span<const double> numbers) const;

  /// What that rank sent first of what has not been taken.
  /// @throws Interrupted  when this rank is stopped
  /// @throws              on rank 0 as RankFailure::rethrow() when another has failed
  /// @throws std::logic_error  for a parcel that is no exchange's
  [[nodiscard]] std::string bytes_from(int rank);
  [[nodiscard]] std::vector<double> numbers_from(int rank);

  /// @throws Interrupted  when the stop flag is set
  void check_interrupt() const;

 private:
  const Ranks& ranks_;
  const StopFlag* stop_;
  std::vector<std::deque<std::string>> arrived_;  ///< by rank
};

}  // namespace slipmode
