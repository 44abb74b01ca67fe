#pragma once

#include <slipmode/core/ranks.hpp>
#include <slipmode/results/journal.hpp>

#include <memory>
#include <string>

namespace slipmode::results {

/// A study that ranks compute together: rank 0 keeps its journal and hands out pieces, all ranks compute them.
///
/// Every rank runs the same study. A rank asks for as many pieces as keep it busy for a quarter of a second by what its
/// values took so far, one at least; rank 0 gives no more than a fair half of what is left, so that all end together.
/// What is found goes to rank 0's journal at once, value by value. A rank that is stopped stops all.
class Crew {
 public:
  /// Shares a study's journal among all ranks, each of which calls this; what rank 0's holds goes to the others'.
  /// @param journal      of rank 0 the study's, of others one in memory. Must outlive this
  /// @param fingerprint  of the study
  /// @throws InvalidInput  on a rank whose study is another than rank 0's
  /// @throws Interrupted   on a rank that rank 0 has stopped
  Crew(const Ranks& ranks, Journal& journal, const std::string& fingerprint);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

 private:
  class Pace;
  class Lead;
  class Hand;
  std::unique_ptr<Lead> lead_;  ///< of rank 0
  std::unique_ptr<Hand> hand_;  ///< of others
};

}  // namespace slipmode::results
