#include <slipmode/studies/result_file.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/provenance.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cstdlib>
#include <utility>

namespace slipmode::studies {

namespace {

/// "0.21", or the name of what has no number.
std::string name_of(const results::JournalRecord& value) {
  if (!value.note.empty()) return value.note;
  return fmt::format("{} {:.10g}", value.table.substr(0, value.table.rfind('-')), value.values.front());
}

/// Before anything is written.
std::optional<results::Shard> checked(std::optional<results::Shard> shard, const Pieces& pieces,
                                      const std::filesystem::path& path, const std::string& fingerprint) {
  if (!shard) return shard;
  if (shard->count == 0) shard->count = pieces.count;
  if (shard->count > pieces.count) {
    throw InvalidInput(fmt::format("--shard {}: expected at most {} shards, the number of {}",
                                   results::to_string(*shard), pieces.count, pieces.what));
  }
  if (!std::filesystem::exists(path)) return shard;
  const results::JournalText there = results::Journal::read(path);
  if (!there.damaged && there.fingerprint != results::shard_fingerprint(fingerprint, *shard)) {
    throw InvalidInput(fmt::format(
        "-o {}: is a finished part of another shard or study; remove it, or choose another name", path.string()));
  }
  return shard;
}

/// Of ranks that compute together, one that gives its values to the first.
bool is_hand(const Division& division) { return division.ranks != nullptr && division.ranks->own != 0; }

/// Where programs keep what can be made again (XDG Base Directory Specification); empty: nowhere.
std::filesystem::path cache() {
  const auto folder = [](const char* variable) {
    const char* value = std::getenv(variable);
    return std::filesystem::path(value == nullptr ? "" : value);
  };
  if (const auto own = folder("XDG_CACHE_HOME"); own.is_absolute()) return own / "slipmode";
  const auto home = folder("HOME");
  return home.is_absolute() ? home / ".cache" / "slipmode" : std::filesystem::path();
}

std::vector<results::JournalRecord> all_records(const std::vector<results::Part>& parts) {
  std::vector<results::JournalRecord> all;
  for (const results::Part& part : parts) all.insert(all.end(), part.records.begin(), part.records.end());
  return all;
}

}  // namespace

std::string fingerprint_of(const scene::Scene& scene, const std::string& command, const std::string& identity) {
  return results::fingerprint(fmt::format("{}\n{}\n{}\n{}\n{}", results::version(), results::rounding(), command,
                                          identity, scene::scene_to_toml(scene)));
}

ResultFile::ResultFile(std::filesystem::path path, scene::Scene scene, results::FileKind kind, std::string command,
                       const std::string& identity, const Division& division, const Pieces& pieces,
                       Unfinished unfinished)
    : path_(std::move(path)),
      scene_(std::move(scene)),
      kind_(kind),
      command_(std::move(command)),
      fingerprint_(fingerprint_of(scene_, command_, identity)),
      shard_(checked(division.shard, pieces, path_, fingerprint_)) {
  if (path_.empty()) {
    if (unfinished == Unfinished::kKept && division.joined.empty()) keep_in_cache();
    return;
  }
  if (division.joined.empty() && !is_hand(division)) {
    journal_.emplace(results::Journal::path_for(path_),
                     shard_ ? results::shard_fingerprint(fingerprint_, *shard_) : fingerprint_);
  } else {
    journal_.emplace(all_records(division.joined));
  }
  if (division.ranks != nullptr) crew_.emplace(*division.ranks, *journal_, fingerprint_);
  if (shard_) begin_part(division.words);
  if (!division.joined.empty()) join(division.joined);
  resumed_ = finished();
}

ResultFile::~ResultFile() {
  if (journal_ && journal_->records().empty()) journal_->remove();
}

void ResultFile::drop() {
  if (journal_) journal_->remove();
}

void ResultFile::keep_in_cache() {
  const std::filesystem::path folder = cache();
  std::error_code none;
  if (folder.empty() || (std::filesystem::create_directories(folder, none), none)) return;
  try {
    // Nobody named the file, so nobody knows that another build began it.
    const std::string own = results::fingerprint(fingerprint_ + results::git_commit());
    journal_.emplace(results::Journal::path_for(folder / own), own);
    resumed_ = finished();
  } catch (
      const InvalidInput&) {  // another process computes the same, or the disc is full: it is computed all the same
    journal_.reset();
  }
}

void ResultFile::begin_part(const std::vector<std::string>& words) {
  journal_->set_leave([shard = *shard_](std::size_t piece, const auto&) { return !shard.has(piece); });
  if (!journal_->records().empty()) return;
  if (std::filesystem::exists(path_)) {  // the same part, computed before
    const results::JournalText whole = results::Journal::read(path_);
    if (!whole.damaged) {
      for (const results::JournalRecord& record : whole.records) journal_->append(record);
    }
  }
  if (!journal_->records().empty()) return;
  journal_->append(results::to_record({.shard = *shard_,
                                       .version = results::version(),
                                       .rounding = results::rounding(),
                                       .command = command_,
                                       .words = words,
                                       .scene = scene_.source}));
}

void ResultFile::join(const std::vector<results::Part>& parts) {
  lacks_.resize(parts.size());
  for (const results::Part& part : parts) {
    if (part.fingerprint != fingerprint_) {
      throw InvalidInput(
          fmt::format("{}: the files that '{}' reads are not those it was computed with; give them back, or compute "
                      "the parts anew",
                      part.path.string(), command_));
    }
    lacks_[part.head.shard.number - 1] = {part.path.string(), results::command_line(part), {}};
  }
  journal_->set_leave([this](std::size_t piece, const results::JournalRecord& value) {
    lacks_[piece % lacks_.size()].values.push_back(value);
    return true;
  });
}

void ResultFile::require_all() const {
  constexpr std::size_t kNamed = 8;
  std::string text;
  for (const Lack& part : lacks_) {
    if (part.values.empty()) continue;
    std::string names;
    for (std::size_t k = 0; k < std::min(kNamed, part.values.size()); ++k)
      names += (names.empty() ? "" : ", ") + name_of(part.values[k]);
    if (part.values.size() > kNamed) names += ", ...";
    text += fmt::format("{}: unfinished, {} values are missing ({}); finish it with\n  {}\n", part.path,
                        part.values.size(), names, part.command);
  }
  if (!text.empty()) throw InvalidInput(text.substr(0, text.size() - 1));
}

results::Content ResultFile::finish(std::function<void(results::StoreWriter&)> write,
                                    const std::optional<dynamics::EnergyAudit>& audit) {
  results::Provenance provenance = results::provenance_of(scene_, command_);
  provenance.audit = audit;
  results::Content content{
      .kind = kind_,
      .unit_system = scene_.units,
      .write = [provenance = std::move(provenance), write = std::move(write)](results::StoreWriter& writer) {
        results::save(writer, provenance);
        write(writer);
      }};
  if (!journal_ || !journal_->sharing().leads) return content;
  if (shard_) {
    journal_->publish(path_);
    return content;
  }
  require_all();
  if (!path_.empty()) content.save(path_);
  journal_->remove();
  return content;
}

Pieces chains(std::size_t count, const std::string& more) {
  return {.count = count,
          .what = fmt::format("chains of values, each of which starts where the one before it ended (more {})", more)};
}

std::string identity_of(const pod::Basis& basis) {
  std::string bytes = fmt::format("{} x {}\n", basis.vectors.rows(), basis.vectors.cols());
  const auto append = [&bytes](const auto& numbers) {
    bytes.append(reinterpret_cast<const char*>(numbers.data()),
                 static_cast<std::size_t>(numbers.size()) * sizeof(double));
  };
  append(basis.vectors);
  append(basis.mean);
  return results::fingerprint(bytes);
}

}  // namespace slipmode::studies
