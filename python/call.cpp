#include "python/call.hpp"

#include <slipmode/results/store.hpp>

#include <fmt/ranges.h>

#include <array>
#include <chrono>
#include <csignal>
#include <mutex>

namespace slipmode::python {
namespace {

/// One per running call: a signal handler can reach no more than fixed memory.
struct Slot {
  std::atomic<bool> used = false;
  StopFlag stop = false;
};
constexpr int kSlots = 256;
std::array<Slot, kSlots> slots;
static_assert(StopFlag::is_always_lock_free, "only lock-free atomics may be used in a signal handler");

std::mutex watching;
int watched = 0;
bool installed = false;
struct sigaction before = {};

/// Stops the calls that run; then Python's own handler, which makes KeyboardInterrupt of it.
void stop_all(int signal) {
  for (Slot& slot : slots) {
    if (slot.used.load()) slot.stop.store(true);
  }
  before.sa_handler(signal);
}

/// @return  the call's slot, or −1: then Ctrl-C waits for its end
int begin_watch() {
  const std::scoped_lock lock(watching);
  int own = -1;
  for (int k = 0; k < kSlots && own < 0; ++k) {
    if (slots[static_cast<std::size_t>(k)].used.load()) continue;
    slots[static_cast<std::size_t>(k)].stop.store(false);
    slots[static_cast<std::size_t>(k)].used.store(true);
    own = k;
  }
  if (watched++ > 0) return own;
  struct sigaction now = {};
  sigaction(SIGINT, nullptr, &now);
  if (now.sa_handler == stop_all) return own;  // saved during a call and set again later: `before` still is Python's
  before = now;
  const bool handled =
      (before.sa_flags & SA_SIGINFO) == 0 && before.sa_handler != SIG_DFL && before.sa_handler != SIG_IGN;
  if (!handled) return own;
  struct sigaction action = before;
  action.sa_handler = stop_all;
  sigaction(SIGINT, &action, nullptr);
  installed = true;
  return own;
}

void end_watch(int own) {
  const std::scoped_lock lock(watching);
  if (own >= 0) slots[static_cast<std::size_t>(own)].used.store(false);
  if (--watched > 0 || !installed) return;
  installed = false;
  struct sigaction now = {};
  sigaction(SIGINT, nullptr, &now);
  if (now.sa_handler == stop_all) sigaction(SIGINT, &before, nullptr);  // unless a handler was set meanwhile
}

}  // namespace

std::string python_name(const std::string& name) { return name == "from" ? "from_" : name; }

py::object Keywords::take(const std::string& own_name) {
  const std::string name = python_name(own_name);
  if (!given_.contains(name)) return {};
  py::object value = given_[name.c_str()];
  PyDict_DelItemString(given_.ptr(), name.c_str());
  return value.is_none() ? py::object() : value;
}

std::string Keywords::text(const char* name, std::string otherwise) {
  known_.emplace_back(name);
  const py::object value = take(name);
  if (!value) return otherwise;
  if (!py::isinstance<py::str>(value)) refuse(name, value, "a text");
  return value.cast<std::string>();
}

std::string Keywords::output() {
  std::string file = text("output");
  if (!file.empty()) results::require_writable(file);
  return file;
}

void Keywords::finish() const {
  if (given_.empty()) return;
  const auto [name, value] = *given_.begin();
  throw InvalidInput(fmt::format("{}: {} = {}: no such option; valid: {}", call_, std::string(py::str(name)),
                                 std::string(py::repr(value)), fmt::join(known_, ", ")));
}

void Keywords::refuse(const std::string& name, const py::handle& value, const std::string& expected) const {
  throw InvalidInput(fmt::format("{}: {} = {}: expected {}", call_, name, std::string(py::repr(value)), expected));
}

struct Call::Progress {
  using Clock = std::chrono::steady_clock;
  static constexpr auto kFirst = std::chrono::milliseconds(300), kEvery = std::chrono::milliseconds(100);

  py::object function;
  StopFlag* stop = nullptr;  ///< ends the call when the function fails
  std::exception_ptr error = {};
  Clock::time_point next = Clock::now() + kFirst;
  bool shown = false;

  void update(const std::string& part, std::size_t done, std::size_t total) {
    const bool last = done == total && shown;
    if (error || (!last && Clock::now() < next)) return;
    const py::gil_scoped_acquire locked;
    try {
      function(part, done, total);
    } catch (const py::error_already_set&) {
      error = std::current_exception();
      if (stop != nullptr) stop->store(true);
    }
    next = Clock::now() + kEvery;
    shown = true;
  }
};

Call::Call(Keywords& keywords) : slot_(-1) {
  struct Threads {
    int threads = 0;
    static constexpr auto fields() {
      return std::tuple{optional("threads", &Threads::threads, "", "0: as many as the machine runs at once",
                                 {.low = 0.0, .high = 4096.0})};
    }
  } own;
  keywords.read(own);
  options_.threads = own.threads;
  if (py::object function = keywords.take("progress")) {
    if (PyCallable_Check(function.ptr()) == 0)
      keywords.refuse("progress", function, "a function of part, done and total");
    progress_ = std::make_shared<Progress>(Progress{.function = std::move(function)});
    options_.progress = [progress = progress_.get()](const std::string& part) {
      return [progress, part](std::size_t done, std::size_t total) { progress->update(part, done, total); };
    };
  }
  keywords.finish();
  slot_ = begin_watch();
  if (slot_ < 0) return;
  StopFlag& stop = slots[static_cast<std::size_t>(slot_)].stop;
  options_.stop = &stop;
  if (progress_) progress_->stop = &stop;
}

Call::~Call() { end_watch(slot_); }

void Call::raise_interrupt() const {
  raise_progress_error();
  if (PyErr_CheckSignals() == 0) PyErr_SetNone(PyExc_KeyboardInterrupt);  // of another thread's Ctrl-C
  throw py::error_already_set();
}

void Call::raise_progress_error() const {
  if (progress_ && progress_->error) std::rethrow_exception(progress_->error);
}

std::string call_text() {
  return "    threads (int): 0: as many as the machine runs at once (default 0)\n"
         "    progress (Callable[[str, int, int], object] | bool): called with part, done, total; False: none; else "
         "tqdm\n"
         "        where it is installed\n";
}

}  // namespace slipmode::python
