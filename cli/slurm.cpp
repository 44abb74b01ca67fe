#include "cli/slurm.hpp"

#include <slipmode/core/files.hpp>
#include <slipmode/results/part.hpp>
#include "cli/verbs.hpp"

#include <sys/resource.h>

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

namespace slipmode::cli {
namespace {

namespace fs = std::filesystem;
using results::shell_word;

/// What one process needs, measured with one thread.
struct Cost {
  std::size_t pieces = 0;
  double set_up = 0.0, piece = 0.0;  ///< s
  double memory = 0.0;               ///< MB at most
  std::uintmax_t bytes = 0;          ///< of a piece in a part
};

/// A part of no piece, or of the first one; its time in s.
double time_of(const Session& session, std::size_t number, const fs::path& part) {
  const auto begin = std::chrono::steady_clock::now();
  const Session own{.quiet = true,
                    .threads = 1,
                    .stop = session.stop,
                    .shard = results::Shard{.number = number, .count = 0},
                    .words = session.words};
  if (replay(session.words, part.string(), own).exit_code == kInterrupted) throw Interrupted();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void check_pieces(const Session& session, std::size_t pieces) {
  if (pieces < 2) throw InvalidInput("--slurm: the study is one piece, which no shards can divide; run it as it is");
  if (session.shards && *session.shards > pieces) {
    throw InvalidInput(fmt::format("--shards {}: expected at most {}, the pieces that the study can be divided into",
                                   *session.shards, pieces));
  }
}

Cost measure(const Session& session) {
  const fs::path none = fs::path(session.slurm) / "none.part", first = fs::path(session.slurm) / "first.part";
  const auto tidy = [&] {
    for (const fs::path& part : {none, first}) {
      fs::remove(part);
      fs::remove(results::Journal::path_for(part));
    }
  };
  tidy();
  Cost cost;
  cost.set_up = time_of(session, 0, none);
  cost.pieces = results::read_part(none).head.shard.count;
  cost.bytes = fs::file_size(none);
  fs::remove(none);
  check_pieces(session, cost.pieces);
  cost.piece = std::max(time_of(session, 1, first) - cost.set_up, 1e-4);
  cost.bytes = fs::file_size(first) - cost.bytes;
  tidy();
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  cost.memory = static_cast<double>(used.ru_maxrss) / 1024.0;
  return cost;
}

/// As many that each takes ten minutes or more, most of it for values.
std::size_t shards_of(const Session& session, const Cost& cost) {
  constexpr double kWorthwhile = 600.0, kSetUps = 20.0;
  const double all = static_cast<double>(cost.pieces) * cost.piece / std::max(kWorthwhile, kSetUps * cost.set_up);
  return session.shards.value_or(std::clamp(static_cast<std::size_t>(std::ceil(all)), std::size_t{1}, cost.pieces));
}

/// #SBATCH lines common to both jobs. @param minutes  of the limit  @param megabytes  of memory
std::string directives(const std::string& name, double minutes, double megabytes, const fs::path& log) {
  return fmt::format(
      "#!/bin/bash\n#SBATCH --job-name={}\n#SBATCH --chdir={}\n#SBATCH --output={}\n#SBATCH --open-mode=append\n"
      "#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=1\n#SBATCH --time={}\n#SBATCH --mem={}M\n",
      name, shell_word(fs::current_path().string()), shell_word(log.string()), std::ceil(minutes),
      std::ceil(megabytes));
}

}  // namespace

Report write_slurm(const Session& session, const std::string& output) {
  if (session.shard) throw InvalidInput("--slurm and --shard: expected one of them; the scripts give --shard");
  std::error_code error;
  fs::create_directories(session.slurm, error);
  const fs::path folder = fs::absolute(session.slurm).lexically_normal();
  require_writable(folder / "array.sh");
  require_writable(output);
  const Cost cost = measure(session);
  const std::size_t shards = shards_of(session, cost);
  const double share = std::ceil(static_cast<double>(cost.pieces) / static_cast<double>(shards));
  const double seconds = cost.set_up + share * cost.piece;
  const double minutes = 5.0 + 2.0 * seconds / 60.0, memory = 100.0 + 1.5 * cost.memory;
  const double warned = std::clamp(2.0 * cost.piece, 60.0, 60.0 * minutes / 2.0);
  const std::string program = shell_word(fs::read_symlink("/proc/self/exe").string());
  const std::string measured = fmt::format(
      "# Measured: {:.3g} s of set-up, {:.3g} s for the first of {} pieces, {:.0f} MB; a shard of {:.0f} takes about "
      "{:.3g} s.\n# Others may take longer: the limit is twice that and five minutes, and what is stopped goes on.\n",
      cost.set_up, cost.piece, cost.pieces, cost.memory, share, seconds);

  std::string words;
  for (const std::string& word : session.words) words += " " + shell_word(word);
  const std::string part = shell_word(folder.string() + "/") + "\"$SLURM_ARRAY_TASK_ID\".part";
  const std::string name = session.words.front();
  write_renamed(folder / "array.sh",
                directives("slipmode-" + name, minutes, memory, folder / "%a.log") +
                    fmt::format("#SBATCH --array=1-{}\n#SBATCH --requeue\n#SBATCH --signal=B:USR1@{:.0f}\n{}", shards,
                                std::ceil(warned), measured) +
                    fmt::format(R"sh(part={}
size() {{ stat -c %s "$part.journal" 2>/dev/null || echo 0; }}
before=$(size)
trap 'kill -USR1 "$shard"' USR1
trap 'kill -TERM "$shard"' TERM
{}{} --shard "$SLURM_ARRAY_TASK_ID/{}" -o "$part" --threads "${{SLURM_CPUS_PER_TASK:-1}}" --quiet &
shard=$!
wait "$shard"
while kill -0 "$shard" 2>/dev/null; do wait "$shard"; done  # a signal ended the waiting, not the shard
wait "$shard"  # its own code, which bash remembers
code=$?
if [ "$code" -eq 130 ] && [ "$(size)" -gt "$before" ]; then  # out of time, and further than before
  scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
)sh",
                                part, program, words, shards));
  write_renamed(folder / "merge.sh",
                directives("slipmode-merge", minutes + 2.0 * cost.set_up / 60.0,
                           memory + 4e-6 * static_cast<double>(cost.bytes * cost.pieces), folder / "merge.log") +
                    measured +
                    fmt::format("exec {} merge {}{{1..{}}}.part -o {}\n", program, shell_word(folder.string() + "/"),
                                shards, shell_word(output)));
  write_renamed(folder / "submit.sh", fmt::format("#!/bin/bash\nset -e\narray=$(sbatch --parsable {0}/array.sh)\n"
                                                  "sbatch --dependency=\"afterok:${{array%%;*}}\" {0}/merge.sh\n",
                                                  shell_word(folder.string())));
  Report report;
  report.data = {{"verb", name},
                 {"folder", folder.string()},
                 {"shards", shards},
                 {"pieces", cost.pieces},
                 {"set_up_s", cost.set_up},
                 {"piece_s", cost.piece},
                 {"memory_mb", cost.memory},
                 {"limit_minutes", std::ceil(minutes)}};
  report.text = fmt::format(
      "Measured: {:.3g} s of set-up, {:.3g} s for the first of {} pieces, {:.0f} MB; others may take longer\n"
      "{} shards of about {:.3g} s, stopped after {:.0f} minutes and put in the queue again\n"
      "Submit with: bash {}\n",
      cost.set_up, cost.piece, cost.pieces, cost.memory, shards, seconds, std::ceil(minutes),
      shell_word((folder / "submit.sh").string()));
  return report;
}

}  // namespace slipmode::cli
