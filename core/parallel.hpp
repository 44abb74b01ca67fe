#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <stdexcept>
#include <vector>

namespace slipmode {

/// Set from anywhere, a signal handler included, to end a batch after the items now being computed.
using StopFlag = std::atomic<bool>;

/// Thrown by a long computation that found its StopFlag set. Nothing is wrong; what was finished before stays valid.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted before it was finished; finished parts are kept") {}
};

/// Called after each finished item, one call at a time, from whichever thread finished it.
using ProgressCallback = std::function<void(std::size_t done, std::size_t total)>;

/// How a batch is run. Nothing here may change a result, only how long it takes.
struct ParallelOptions {
  int threads = 0;                 ///< number of threads, ≥ 0; 0: as many as the machine runs at once
  const StopFlag* stop = nullptr;  ///< polled before each item; nullptr: never stops
  ProgressCallback progress = {};
};

/// What became of a batch of `count` items.
struct BatchResult {
  std::vector<std::exception_ptr> errors;  ///< one per item; null where the item went well or was not started
  std::vector<char> started;               ///< one per item; 0 where the stop flag came first
  bool interrupted = false;                ///< true when some item was not started
};

/// Calls item(0) … item(count − 1), each once, on several threads.
///
/// The next free index goes to the next free thread, so uneven items balance. An item writes its result by its index
/// and reads nothing another item writes: then the bytes are the same for any number of threads. An exception ends
/// its own item only. One thread runs the items in order in the caller's thread.
/// @throws InvalidInput  if threads < 0
BatchResult parallel_for(std::size_t count, const ParallelOptions& options,
                         const std::function<void(std::size_t)>& item);

/// Throws the error of the lowest item that failed, or Interrupted when an item was not started.
void rethrow_first(const BatchResult& batch);

/// Runs tasks that make further tasks possible: run(id) returns the ids that may start now.
///
/// Of the tasks ready, the lowest id starts first. A task id must become ready once. With results written by id and
/// read only by tasks that were made ready by the writer, the bytes are the same for any number of threads.
/// The first exception ends the batch (running tasks finish) and is thrown again here.
/// @param total  number of tasks in all, for the progress callback only
/// @param more   asked for further ids whenever a thread finds none ready, by one thread at a time; may wait. Gives
/// none
///               when there will be none. Empty function: `ready` and what follows from it is all
/// @return false when the stop flag ended it before every task was run
/// @throws InvalidInput  if threads < 0
bool run_tasks(std::vector<std::size_t> ready, std::size_t total, const ParallelOptions& options,
               const std::function<std::vector<std::size_t>(std::size_t)>& run,
               const std::function<std::vector<std::size_t>()>& more = {});

/// The number of threads `options` asks for, at least 1. @throws InvalidInput  if threads < 0
[[nodiscard]] int thread_count(const ParallelOptions& options);

}  // namespace slipmode
