#include "cli/trade_request.hpp"

#include <slipmode/core/progress.hpp>
#include <slipmode/results/journal.hpp>

#include <unistd.h>

#include <fmt/format.h>
#include <charconv>
#include <fstream>
#include <memory>

namespace slipmode::cli {
namespace {

/// A positive number and what follows it, blanks in between left out.
struct Quantity {
  double number = 0.0;
  std::string unit;
};

std::optional<Quantity> read_quantity(const std::string& text) {
  Quantity found;
  const auto [stopped, error] = std::from_chars(text.data(), text.data() + text.size(), found.number);
  if (error != std::errc() || !(found.number > 0.0)) return std::nullopt;
  found.unit = std::string(stopped, text.data() + text.size());
  found.unit.erase(0, found.unit.find_first_not_of(' '));
  return found;
}

/// One line per batch of work, each with its own time left.
class Progress {
 public:
  explicit Progress(const Session& session) : mode_(session.progress_mode()) {}

  void update(std::size_t done, std::size_t total) {
    if (!line_ || total != total_ || done < done_) {
      line_.reset();
      line_ = std::make_unique<ProgressLine>("trade", mode_);
    }
    done_ = done;
    total_ = total;
    line_->update(done, total);
  }

 private:
  ProgressMode mode_;
  std::unique_ptr<ProgressLine> line_;
  std::size_t done_ = 0, total_ = 0;
};

constexpr const char* kTable = "errors";

results::JournalRecord to_record(std::size_t index, const std::string& name, const trade::Finished& finished) {
  results::JournalRecord record{.table = kTable, .index = static_cast<std::int64_t>(index), .values = {}, .note = name};
  record.values.assign(finished.error.begin(), finished.error.end());
  record.values.insert(record.values.end(), finished.noise.begin(), finished.noise.end());
  return record;
}

std::optional<trade::Finished> recalled(const results::Journal& journal, const std::string& name) {
  for (const results::JournalRecord& record : journal.records()) {
    if (record.note != name || record.values.size() != 2 * trade::kMeasures) continue;
    trade::Finished finished;
    const auto middle = record.values.begin() + static_cast<std::ptrdiff_t>(trade::kMeasures);
    std::copy(record.values.begin(), middle, finished.error.begin());
    std::copy(middle, record.values.end(), finished.noise.begin());
    return finished;
  }
  return std::nullopt;
}

}  // namespace

double parse_percent(const std::string& option, const std::string& text) {
  const auto found = read_quantity(text);
  if (found && (found->unit.empty() || found->unit == "%")) return found->number;
  throw InvalidInput(fmt::format("{} {}: expected a share in percent, e.g. 1%", option, text));
}

double parse_duration(const std::string& option, const std::string& text) {
  const auto found = read_quantity(text);
  if (found && (found->unit.empty() || found->unit == "s")) return found->number;
  if (found && found->unit == "ms") return 1e-3 * found->number;
  if (found && found->unit == "min") return 60.0 * found->number;
  throw InvalidInput(fmt::format("{} {}: expected a time in s, ms or min, e.g. 10s", option, text));
}

trade::Measure parse_measure(const std::string& word) {
  std::string valid;
  for (std::size_t m = 0; m < trade::kMeasures; ++m) {
    const auto measure = static_cast<trade::Measure>(m);
    if (trade::to_string(measure) == word) return measure;
    valid += (valid.empty() ? "" : ", ") + std::string(trade::to_string(measure));
  }
  throw InvalidInput(fmt::format("--measure {}: no such measure; valid: {}", word, valid));
}

void run_study(const Session& session, const std::filesystem::path& output, const std::string& identity,
               const std::function<trade::Study(trade::StudyOptions)>& study,
               const std::function<void(const trade::Study&)>& finish) {
  Progress progress(session);
  trade::StudyOptions options;
  options.parallel = {.threads = session.threads,
                      .stop = session.stop,
                      .progress = [&](std::size_t done, std::size_t n) { progress.update(done, n); }};
  std::optional<results::Journal> journal;
  if (!output.empty()) {
    journal.emplace(results::Journal::path_for(output), results::fingerprint(identity));
    options.recall = [&](const std::string& name) { return recalled(*journal, name); };
    options.store = [&](const std::string& name, const trade::Finished& finished) {
      if (finished.failure.empty()) journal->append(to_record(journal->records().size(), name, finished));
    };
  }
  finish(study(std::move(options)));
  if (journal) journal->remove();
}

void write_renamed(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::path temporary = path;
  temporary += fmt::format(".{}.partial", getpid());
  std::ofstream out(temporary, std::ios::binary);
  out << text;
  out.close();
  if (!out) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw InvalidInput(fmt::format("cannot write '{}': is the disc full?", path.string()));
  }
  std::filesystem::rename(temporary, path);
}

}  // namespace slipmode::cli
