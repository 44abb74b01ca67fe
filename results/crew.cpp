#include <slipmode/results/crew.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/numbers.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace slipmode::results {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr double kBusy = 0.25;                          // s, that pieces handed out at once keep a rank busy
constexpr auto kWatch = milliseconds(2);                // between two looks for what has arrived: under 1 % of a core
constexpr auto kWait = std::chrono::microseconds(100);  // of a thread that has nothing else to do
constexpr auto kPatience = milliseconds(200);           // mpirun kills a second after it has asked to end, or at once
constexpr std::size_t kMost = std::size_t{1} << 20;     // bytes of a parcel of records

// Parcels: a letter, and text. To rank 0 a record (its line), a wish for pieces ("stage number"), the end of a stage
// ("stage 1", or "stage 0" where it was stopped). From it records (lines), the study's fingerprint after the last of
// them, pieces ("1 2 3"), and two without text.
enum class Sent : char {
  kRecord = 'r',
  kWish = 'w',
  kDone = 'd',
  kRecords = 'R',
  kStudy = 'S',
  kPieces = 'P',
  kComplete = 'C',  ///< all records of a stage were sent
  kStop = 'X',
};

std::string bytes_of(Sent kind, std::string_view text = "") {
  return std::string(1, static_cast<char>(kind)) + std::string(text);
}

Sent kind_of(const Parcel& arrived) { return static_cast<Sent>(arrived.bytes.front()); }

std::string_view text_of(const Parcel& arrived) { return std::string_view(arrived.bytes).substr(1); }

bool is_set(const StopFlag* stop) { return stop != nullptr && stop->load(); }

/// Separated by blanks.
std::vector<std::size_t> numbers_in(std::string_view text) {
  std::vector<std::size_t> numbers;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    numbers.push_back(number_in<std::size_t>(text.substr(0, end)).value());
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return numbers;
}

/// The records from `first` on, in parcels of some size.
void send_records(const Ranks& ranks, const Journal& journal, std::size_t first) {
  const auto send = [&ranks](const std::string& lines) {
    for (int to = 1; to < ranks.count; ++to) ranks.send(to, bytes_of(Sent::kRecords, lines));
  };
  std::string lines;
  for (std::size_t k = first; k < journal.records().size(); ++k) {
    lines += to_line(journal.records()[k]);
    if (lines.size() > kMost) send(std::exchange(lines, ""));
  }
  if (!lines.empty()) send(lines);
}

void take_over(std::string_view lines, Journal& journal) {
  while (!lines.empty()) {
    const std::size_t end = lines.find('\n') + 1;
    journal.take_over(lines.substr(0, end));
    lines.remove_prefix(end);
  }
}

}  // namespace

/// How fast a rank is: how many pieces keep it busy.
class Crew::Pace {
 public:
  void begin(std::size_t pieces, std::size_t values) {
    found_ = 0;
    pieces_per_value_ = static_cast<double>(pieces) / static_cast<double>(std::max<std::size_t>(values, 1));
    start_ = Clock::now();
  }
  void count() { ++found_; }
  [[nodiscard]] std::size_t wish() const {
    if (found_ == 0) return 1;
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    const double pieces = kBusy / elapsed * static_cast<double>(found_) * pieces_per_value_;
    return static_cast<std::size_t>(std::clamp(pieces, 1.0, 1e6));
  }

 private:
  std::atomic<std::size_t> found_ = 0;
  double pieces_per_value_ = 1.0;
  Clock::time_point start_;
};

/// Rank 0. While a stage, that is a sweep, runs, a thread of its own answers the others.
class Crew::Lead {
 public:
  Lead(const Ranks& ranks, Journal& journal, const std::string& fingerprint)
      : ranks_(ranks), journal_(journal), done_(static_cast<std::size_t>(ranks.count), 0), heard_(done_.size()) {
    send_records(ranks_, journal_, 0);
    tell_all(Sent::kStudy, fingerprint);
    journal_.share({.begin = [this](std::vector<std::size_t> open, std::size_t done, std::size_t total,
                                    const ParallelOptions& run) { begin(std::move(open), done, total, run); },
                    .take = [this] { return take(); },
                    .end = [this](bool finished, bool for_all) { return end(finished, for_all); }},
                   [this](const JournalRecord&) {
                     pace_.count();
                     count();
                   });
  }

 private:
  void begin(std::vector<std::size_t> open, std::size_t done, std::size_t total, const ParallelOptions& run) {
    ++stage_;
    first_record_ = journal_.records().size();
    finished_ = done;
    total_ = total;
    progress_ = run.progress;
    stop_ = run.stop;
    pace_.begin(open.size(), total - done);
    open_.assign(open.begin(), open.end());
    std::ranges::fill(done_, 0);
    std::ranges::fill(heard_, std::nullopt);
    for (const auto& [from, wish] : std::exchange(early_, {})) answer(from, wish);
    server_ = std::jthread([this](const std::stop_token& over) { serve(over); });
  }

  std::vector<std::size_t> take() {
    const std::scoped_lock lock(mutex_);
    if (error_) std::rethrow_exception(error_);
    if (stopping_) throw Interrupted();
    return next(pace_.wish());
  }

  bool end(bool finished, bool for_all) {
    wait_for_all(finished);
    server_ = {};
    if (error_) std::rethrow_exception(error_);
    if (stopping_) {
      tell_all(Sent::kStop);
    } else if (for_all) {
      send_records(ranks_, journal_, first_record_);
      tell_all(Sent::kComplete);
    }
    return !stopping_;
  }

  /// Of ranks that are stopped it waits for the values they are at. One that has died never answers.
  void wait_for_all(bool finished) {
    std::unique_lock lock(mutex_);
    stopping_ = stopping_ || !finished;
    std::optional<Clock::time_point> stopped;
    while (!error_ && std::count(done_.begin() + 1, done_.end(), 0) > 0) {
      changed_.wait_for(lock, milliseconds(10));
      stopping_ = stopping_ || is_set(stop_);
      if (!stopping_) continue;
      if (!stopped) stopped = Clock::now();
      if (Clock::now() - *stopped > kPatience + 2 * longest_) return;
    }
  }

  void serve(const std::stop_token& over) {
    try {
      while (!over.stop_requested()) {
        while (const auto arrived = ranks_.receive()) handle(*arrived);
        std::this_thread::sleep_for(kWatch);
      }
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      error_ = std::current_exception();
    }
  }

  void handle(const Parcel& arrived) {
    const std::string_view text = text_of(arrived);
    hear(arrived.from);
    if (kind_of(arrived) == Sent::kRecord) {
      journal_.take_over(text);
      count();
      return;
    }
    const std::scoped_lock lock(mutex_);
    if (const auto failure = failure_in(arrived)) {
      fail(*failure);
    } else if (kind_of(arrived) == Sent::kWish) {
      const auto numbers = numbers_in(text);  // stage, wish
      if (numbers[0] == stage_) {
        answer(arrived.from, numbers[1]);
      } else {
        early_.emplace_back(arrived.from, numbers[1]);
      }
    } else {
      end_of(arrived.from, numbers_in(text)[1] != 0);
    }
    changed_.notify_all();
  }

  void fail(const RankFailure& failure) {
    try {
      failure.rethrow();
    } catch (const Interrupted&) {
      end_of(failure.rank, false);
    } catch (...) {
      error_ = std::current_exception();
    }
  }

  void end_of(int rank, bool finished) {
    done_[static_cast<std::size_t>(rank)] = 1;
    stopping_ = stopping_ || !finished;
  }

  void answer(int to, std::size_t wish) {
    ranks_.send(
        to, stopping_ ? bytes_of(Sent::kStop) : bytes_of(Sent::kPieces, fmt::format("{}", fmt::join(next(wish), " "))));
  }

  std::vector<std::size_t> next(std::size_t wish) {
    const std::size_t fair = open_.size() / (2 * done_.size());
    const std::size_t many = std::min(open_.size(), std::min(wish, std::max<std::size_t>(fair, 1)));
    const auto end = open_.begin() + static_cast<std::ptrdiff_t>(many);
    std::vector<std::size_t> pieces(open_.begin(), end);
    open_.erase(open_.begin(), end);
    return pieces;
  }

  void count() {
    const std::scoped_lock lock(mutex_);
    ++finished_;
    if (progress_) progress_(finished_, total_);
  }

  void hear(int from) {
    const std::scoped_lock lock(mutex_);
    auto& last = heard_[static_cast<std::size_t>(from)];
    if (last) longest_ = std::max(longest_, Clock::now() - *last);
    last = Clock::now();
  }

  void tell_all(Sent kind, const std::string& text = "") {
    for (int to = 1; to < ranks_.count; ++to) ranks_.send(to, bytes_of(kind, text));
  }

  const Ranks& ranks_;
  Journal& journal_;
  std::size_t stage_ = 0, first_record_ = 0;  ///< its number from 1, and the first record of it
  std::size_t finished_ = 0, total_ = 0;      ///< values
  ProgressCallback progress_;
  const StopFlag* stop_ = nullptr;
  Pace pace_;
  std::deque<std::size_t> open_;                         ///< pieces not yet given
  std::vector<std::pair<int, std::size_t>> early_;       ///< wishes of ranks that are at the next stage already
  std::vector<char> done_;                               ///< by rank: 1 when its stage has ended
  std::vector<std::optional<Clock::time_point>> heard_;  ///< by rank: last parcel of this stage
  Clock::duration longest_{};                            ///< time between two parcels of a rank
  bool stopping_ = false;
  std::exception_ptr error_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::jthread server_;
};

/// Any other rank.
class Crew::Hand {
 public:
  Hand(const Ranks& ranks, Journal& journal, const std::string& fingerprint) : ranks_(ranks), journal_(journal) {
    Parcel arrived = wait();
    for (; kind_of(arrived) == Sent::kRecords; arrived = wait()) take_over(text_of(arrived), journal_);
    require_same_study(std::string(text_of(arrived)), fingerprint);
    journal_.share({.begin = [this](const std::vector<std::size_t>& open, std::size_t done, std::size_t total,
                                    const ParallelOptions& run) { begin(open.size(), total - done, run.stop); },
                    .take = [this] { return take(); },
                    .end = [this](bool finished, bool for_all) { return end(finished, for_all); },
                    .leads = false},
                   [this](const JournalRecord& record) {
                     pace_.count();
                     ranks_.send(0, bytes_of(Sent::kRecord, to_line(record)));
                   });
  }

 private:
  void begin(std::size_t pieces, std::size_t values, const StopFlag* stop) {
    ++stage_;
    stop_ = stop;
    pace_.begin(pieces, values);
  }

  std::vector<std::size_t> take() {
    ranks_.send(0, bytes_of(Sent::kWish, fmt::format("{} {}", stage_, pace_.wish())));
    return numbers_in(text_of(wait()));
  }

  bool end(bool finished, bool for_all) {
    ranks_.send(0, bytes_of(Sent::kDone, fmt::format("{} {}", stage_, finished ? 1 : 0)));
    if (!finished || !for_all) return finished;
    try {
      for (Parcel arrived = wait(); kind_of(arrived) == Sent::kRecords; arrived = wait())
        take_over(text_of(arrived), journal_);
    } catch (const Interrupted&) {
      return false;
    }
    return true;
  }

  Parcel wait() {
    for (;;) {
      auto arrived = ranks_.receive();
      if (is_set(stop_)) throw Interrupted();
      if (!arrived) {
        std::this_thread::sleep_for(kWait);
      } else if (kind_of(*arrived) == Sent::kStop) {
        throw Interrupted();
      } else {
        return std::move(*arrived);
      }
    }
  }

  const Ranks& ranks_;
  Journal& journal_;
  const StopFlag* stop_ = nullptr;
  std::size_t stage_ = 0;
  Pace pace_;
};

Crew::Crew(const Ranks& ranks, Journal& journal, const std::string& fingerprint) {
  if (ranks.own == 0) {
    lead_ = std::make_unique<Lead>(ranks, journal, fingerprint);
  } else {
    hand_ = std::make_unique<Hand>(ranks, journal, fingerprint);
  }
}

Crew::~Crew() = default;

}  // namespace slipmode::results
