#include <slipmode/core/ranks.hpp>

#include <slipmode/core/exchange.hpp>
#include <slipmode/core/numbers.hpp>
#include <slipmode/core/parallel.hpp>

#include <fmt/format.h>
#include <chrono>
#include <stdexcept>
#include <string_view>
#include <thread>

namespace slipmode {

namespace {

constexpr int kBadInputCode = 2, kStoppedCode = 130;  // exit codes of failures

}  // namespace

int end_ranks(const Ranks& ranks, int code, const std::string& message) {
  if (ranks.own == 0) {
    if (code != 0) ranks.abort(code);
    for (int to = 1; to < ranks.count; ++to) ranks.send(to, std::string(1, kGoParcel));
  } else {
    if (code != 0) ranks.send(0, fmt::format("{}{} {}", kFailureParcel, code, message));
    // Asleep, not in a barrier that spins: rank 0 may be measuring times.
    for (auto arrived = ranks.receive(); !arrived || arrived->bytes.front() != kGoParcel; arrived = ranks.receive())
      if (!arrived) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  ranks.leave();
  return ranks.own == 0 ? code : 0;
}

void RankFailure::rethrow() const {
  if (code == kStoppedCode) throw Interrupted();
  const std::string why = fmt::format("rank {}: {}", rank, message);
  if (code == kBadInputCode) throw InvalidInputOfRank(why);
  throw std::runtime_error(why);
}

std::optional<RankFailure> failure_in(const Parcel& parcel) {
  if (parcel.bytes.front() != kFailureParcel) return std::nullopt;
  const std::string_view text = std::string_view(parcel.bytes).substr(1);
  const std::size_t blank = text.find(' ');
  return RankFailure{.rank = parcel.from,
                     .code = number_in<int>(text.substr(0, blank)).value(),
                     .message = std::string(text.substr(blank + 1))};
}

void require_same_study(const std::string& of_rank_0, const std::string& own) {
  if (own == of_rank_0) return;
  throw InvalidInput(
      "its study is another than rank 0's: another scene, other files, version or kernels (SLIPMODE_KERNELS); give all "
      "ranks the same");
}

}  // namespace slipmode
