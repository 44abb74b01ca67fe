#include <slipmode/core/parallel.hpp>

#include <slipmode/core/errors.hpp>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <queue>
#include <string>
#include <thread>

namespace slipmode {

namespace {

bool stopped(const ParallelOptions& options) {
  return options.stop != nullptr && options.stop->load(std::memory_order_relaxed);
}

/// Runs `work` in `threads` threads, the caller's among them, and waits for all.
void run_threads(int threads, const std::function<void()>& work) {
  std::vector<std::jthread> helpers;
  helpers.reserve(static_cast<std::size_t>(threads - 1));
  for (int i = 1; i < threads; ++i) helpers.emplace_back(work);
  work();
}

/// The shared part of run_tasks: ready ids, lowest first, and how many tasks are running.
class TaskPool {
 public:
  TaskPool(std::vector<std::size_t> ready, std::size_t total, const ParallelOptions& options,
           const std::function<std::vector<std::size_t>(std::size_t)>& run,
           const std::function<std::vector<std::size_t>()>& more)
      : ready_(std::greater<>{}, std::move(ready)),
        total_(total),
        more_to_come_(static_cast<bool>(more)),
        options_(options),
        run_(run),
        more_(more) {}

  void work() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return !ready_.empty() || may_ask() || (running_ == 0 && !asking_) || ended_; });
      if (ended_ || (ready_.empty() && !may_ask())) break;
      if (stopped(options_)) {
        interrupted_ = true;
        ended_ = true;
        break;
      }
      if (ready_.empty()) {
        ask(lock);
      } else {
        const std::size_t id = ready_.top();
        ready_.pop();
        ++running_;
        run_one(lock, id);
        --running_;
      }
      changed_.notify_all();
    }
    changed_.notify_all();
  }

  /// False when interrupted; throws what a task threw.
  bool finish() {
    if (error_) std::rethrow_exception(error_);
    return !interrupted_;
  }

 private:
  [[nodiscard]] bool may_ask() const { return more_to_come_ && !asking_; }

  void ask(std::unique_lock<std::mutex>& lock) {
    asking_ = true;
    more_to_come_ = add(lock, more_) > 0;
    asking_ = false;
  }

  void run_one(std::unique_lock<std::mutex>& lock, std::size_t id) {
    add(lock, [&] { return run_(id); });
    ++done_;
    end_with(report());
  }

  /// Makes ready what `find` gives, which is called without the lock. @return how many
  template <class Find>
  std::size_t add(std::unique_lock<std::mutex>& lock, const Find& find) {
    std::vector<std::size_t> found;
    std::exception_ptr error;
    lock.unlock();
    try {
      found = find();
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    for (const std::size_t task : found) ready_.push(task);
    end_with(error);
    return found.size();
  }

  void end_with(const std::exception_ptr& error) {
    if (!error) return;
    if (!error_) error_ = error;
    ended_ = true;
  }

  std::exception_ptr report() {
    if (!options_.progress) return nullptr;
    try {
      options_.progress(done_, total_);
      return nullptr;
    } catch (...) {
      return std::current_exception();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>> ready_;
  std::size_t total_;
  std::size_t done_ = 0;
  std::size_t running_ = 0;
  bool more_to_come_;
  bool asking_ = false;
  bool ended_ = false;
  bool interrupted_ = false;
  std::exception_ptr error_;
  const ParallelOptions& options_;
  const std::function<std::vector<std::size_t>(std::size_t)>& run_;
  const std::function<std::vector<std::size_t>()>& more_;
};

}  // namespace

int thread_count(const ParallelOptions& options) {
  if (options.threads < 0) {
    throw InvalidInput("threads: expected a number >= 0 (0: as many as the machine runs at once), found " +
                       std::to_string(options.threads));
  }
  if (options.threads > 0) return options.threads;
  const unsigned available = std::thread::hardware_concurrency();
  return available == 0 ? 1 : static_cast<int>(available);
}

BatchResult parallel_for(std::size_t count, const ParallelOptions& options,
                         const std::function<void(std::size_t)>& item) {
  BatchResult batch{.errors = std::vector<std::exception_ptr>(count), .started = std::vector<char>(count, 0)};
  const auto threads = std::min(static_cast<std::size_t>(thread_count(options)), std::max<std::size_t>(count, 1));
  std::atomic<std::size_t> next{0};
  std::mutex report;
  std::size_t done = 0;
  std::exception_ptr report_error;
  StopFlag broken{false};

  run_threads(static_cast<int>(threads), [&] {
    while (!stopped(options) && !broken.load(std::memory_order_relaxed)) {
      const std::size_t i = next.fetch_add(1);
      if (i >= count) return;
      batch.started[i] = 1;
      try {
        item(i);
      } catch (...) {
        batch.errors[i] = std::current_exception();
      }
      if (!options.progress) continue;
      const std::lock_guard lock(report);
      try {
        options.progress(++done, count);
      } catch (...) {
        report_error = std::current_exception();
        broken = true;
      }
    }
  });
  if (report_error) std::rethrow_exception(report_error);
  for (const char started : batch.started) batch.interrupted = batch.interrupted || started == 0;
  return batch;
}

void rethrow_first(const BatchResult& batch) {
  for (const std::exception_ptr& error : batch.errors) {
    if (error) std::rethrow_exception(error);
  }
  if (batch.interrupted) throw Interrupted();
}

bool run_tasks(std::vector<std::size_t> ready, std::size_t total, const ParallelOptions& options,
               const std::function<std::vector<std::size_t>(std::size_t)>& run,
               const std::function<std::vector<std::size_t>()>& more) {
  const int threads = thread_count(options);
  TaskPool pool(std::move(ready), total, options, run, more);
  run_threads(threads, [&] { pool.work(); });
  return pool.finish();
}

}  // namespace slipmode
