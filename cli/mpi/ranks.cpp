// The ranks of MPI. cli/launched.cpp loads this file's library.

#include <slipmode/core/errors.hpp>
#include <slipmode/core/ranks.hpp>

#include <mpi.h>

#include <limits>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace {

// Requests are waited for in another function than they are made in, of which the checker does not know.
// NOLINTBEGIN(clang-analyzer-optin.mpi.MPI-Checker)
/// MPI is asked for calls from any thread, one at a time.
class Mailbox {
 public:
  void send(int to, std::string bytes) {
    if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw slipmode::InvalidInput(
          "mpirun: a value of more than 2 GB cannot be sent; sample less often, or use --shard");
    const std::scoped_lock lock(mutex_);
    drop_sent();
    Sent& sent = sent_.emplace_back(Sent{.bytes = std::move(bytes)});
    MPI_Isend(sent.bytes.data(), static_cast<int>(sent.bytes.size()), MPI_CHAR, to, 0, MPI_COMM_WORLD, &sent.request);
  }

  std::optional<slipmode::Parcel> receive() {
    const std::scoped_lock lock(mutex_);
    int arrived = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &arrived, &status);
    if (arrived == 0) return std::nullopt;
    int size = 0;
    MPI_Get_count(&status, MPI_CHAR, &size);
    slipmode::Parcel parcel{.from = status.MPI_SOURCE, .bytes = std::string(static_cast<std::size_t>(size), '\0')};
    MPI_Recv(parcel.bytes.data(), size, MPI_CHAR, parcel.from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return parcel;
  }

  void leave() {
    const std::scoped_lock lock(mutex_);
    for (Sent& sent : sent_) MPI_Wait(&sent.request, MPI_STATUS_IGNORE);
    MPI_Finalize();
  }

 private:
  struct Sent {
    std::string bytes;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  void drop_sent() {
    std::erase_if(sent_, [](Sent& sent) {
      int done = 0;
      MPI_Test(&sent.request, &done, MPI_STATUS_IGNORE);
      return done != 0;
    });
  }

  std::mutex mutex_;
  std::list<Sent> sent_;  ///< on their way
};
// NOLINTEND(clang-analyzer-optin.mpi.MPI-Checker)

}  // namespace

/// Joins the ranks that the launcher started. Called once.
/// @return false when this MPI cannot be called from several threads
extern "C" __attribute__((visibility("default"))) bool slipmode_join_ranks(slipmode::Ranks& out_ranks) {
  int threads = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &threads);
  MPI_Comm_rank(MPI_COMM_WORLD, &out_ranks.own);
  MPI_Comm_size(MPI_COMM_WORLD, &out_ranks.count);
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, out_ranks.own, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &out_ranks.on_machine);
  MPI_Comm_free(&machine);
  const auto mailbox = std::make_shared<Mailbox>();
  out_ranks.send = [mailbox](int to, std::string bytes) { mailbox->send(to, std::move(bytes)); };
  out_ranks.receive = [mailbox] { return mailbox->receive(); };
  out_ranks.leave = [mailbox] { mailbox->leave(); };
  out_ranks.abort = [](int code) { MPI_Abort(MPI_COMM_WORLD, code); };
  return threads >= MPI_THREAD_SERIALIZED;
}
