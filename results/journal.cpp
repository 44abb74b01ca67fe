#include <slipmode/results/journal.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/files.hpp>
#include <slipmode/core/numbers.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>
#include <zlib.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <tuple>

namespace slipmode::results {

namespace {

constexpr std::string_view kMagic = "slipmode-journal 1 ";
constexpr double kSyncInterval = 1.0;  // s: a sync costs milliseconds, a row often less

std::uint32_t crc_of(std::string_view text) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size()));
}

std::string escape(const std::string& note) {
  std::string out;
  for (const char c : note) {
    if (c == '\\') {
      out += "\\\\";
    } else if (c == '\n') {
      out += "\\n";
    } else {
      out += c;
    }
  }
  return out;
}

std::string unescape(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      out += text[++i] == 'n' ? '\n' : text[i];
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string_view take_word(std::string_view& rest) {
  const std::size_t space = rest.find(' ');
  const std::string_view word = rest.substr(0, space);
  rest.remove_prefix(space == std::string_view::npos ? rest.size() : space + 1);
  return word;
}

template <class Number>
bool parse(std::string_view word, Number& out_value) {
  const auto value = number_in<Number>(word);
  out_value = value.value_or(out_value);
  return value.has_value();
}

}  // namespace

// "crc table index count v1 .. vcount note\n"; numbers are the shortest text that reads back to the same bits.
std::string to_line(const JournalRecord& record) {
  constexpr std::size_t kChecksum = 9, kNumber = 25;  // characters, with the blank
  std::string line(kChecksum, ' ');
  line.reserve(kChecksum + record.table.size() + 2 * kNumber + kNumber * record.values.size() + 2 * record.note.size());
  fmt::format_to(std::back_inserter(line), "{} {} {}", record.table, record.index, record.values.size());
  std::array<char, kNumber> digits{};
  for (const double value : record.values) {
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    line += ' ';
    line.append(digits.data(), end);
  }
  line += ' ' + escape(record.note);
  fmt::format_to(line.begin(), "{:08x}", crc_of(std::string_view(line).substr(kChecksum)));
  return line += '\n';
}

std::optional<JournalRecord> from_line(std::string_view line) {
  std::uint32_t expected = 0;
  const std::string_view word = take_word(line);
  const auto crc_read = std::from_chars(word.data(), word.data() + word.size(), expected, 16);
  if (crc_read.ec != std::errc() || crc_of(line) != expected) return std::nullopt;
  JournalRecord record;
  record.table = std::string(take_word(line));
  std::size_t count = 0;
  if (!parse(take_word(line), record.index) || !parse(take_word(line), count)) return std::nullopt;
  record.values.resize(count);
  for (double& value : record.values) {
    if (!parse(take_word(line), value)) return std::nullopt;
  }
  record.note = unescape(line);
  return record;
}

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 65536> block{};
  for (;;) {
    const ssize_t got = ::pread(descriptor, block.data(), block.size(), static_cast<off_t>(text.size()));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(block.data(), static_cast<std::size_t>(got));
  }
}

/// Closes the descriptor unless released: the constructor may throw after opening.
class Descriptor {
 public:
  explicit Descriptor(int id) : id_(id) {}
  ~Descriptor() {
    if (id_ >= 0) ::close(id_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return id_; }
  int release() { return std::exchange(id_, -1); }

 private:
  int id_;
};

std::string header_of(const std::string& fingerprint) { return std::string(kMagic) + fingerprint + "\n"; }

/// @param begin  of the records
JournalText records_in(const std::string& text, std::size_t begin) {
  JournalText found{
      .fingerprint = text.substr(kMagic.size(), begin - 1 - kMagic.size()), .records = {}, .whole = begin};
  while (found.whole < text.size()) {
    const std::size_t end = text.find('\n', found.whole);
    if (end == std::string::npos) break;
    auto record = from_line(std::string_view(text).substr(found.whole, end - found.whole));
    if (!record) break;
    found.records.push_back(std::move(*record));
    found.whole = end + 1;
  }
  found.damaged = found.whole < text.size();
  return found;
}

void write_whole(int descriptor, std::string_view line, const std::filesystem::path& path) {
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t wrote = ::write(descriptor, line.data() + done, line.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) {
      throw InvalidInput(
          fmt::format("{}: cannot be written ({}); free some space and run the same command again to resume",
                      path.string(), std::strerror(errno)));
    }
    done += static_cast<std::size_t>(wrote);
  }
}

}  // namespace

Journal::Journal(std::filesystem::path path, const std::string& fingerprint)
    : path_(std::move(path)), fingerprint_(fingerprint) {
  Descriptor file(::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  if (file.get() < 0) {
    throw InvalidInput(fmt::format("{}: cannot be written ({}); check that the folder exists and its permissions",
                                   path_.string(), std::strerror(errno)));
  }
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    throw InvalidInput(
        fmt::format("{}: another process is writing it; wait for it or choose another output", path_.string()));
  }

  const std::string text = read_all(file.get());
  const std::string header = header_of(fingerprint);
  // A kill between creation and the end of the first write leaves a part of the header: nothing is lost by starting
  // anew.
  const bool fresh = text.size() < header.size() && header.starts_with(text);
  if (!fresh && !text.starts_with(kMagic)) {
    throw InvalidInput(fmt::format("{}: is not a journal; remove it or choose another output", path_.string()));
  }
  if (!fresh && !text.starts_with(header)) {
    throw InvalidInput(
        fmt::format("{}: holds unfinished results of another task (other scene, overrides, range, shard or kernels); "
                    "remove it to start anew, or choose another output",
                    path_.string()));
  }

  JournalText found;
  if (!fresh) found = records_in(text, header.size());
  if (found.whole < text.size() && ::ftruncate(file.get(), static_cast<off_t>(found.whole)) != 0) {
    throw InvalidInput(fmt::format("{}: cannot be repaired ({}); remove it", path_.string(), std::strerror(errno)));
  }
  records_ = std::move(found.records);
  if (fresh) write_whole(file.get(), header, path_);
  resumed_ = !records_.empty();
  last_sync_ = now();
  descriptor_ = file.release();
}

Journal::~Journal() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Journal::append(JournalRecord record) {
  if (appended_) appended_(record);
  const std::string line = path_.empty() ? "" : to_line(record);
  keep(std::move(record), line);
}

void Journal::take_over(std::string_view line) {
  auto record = from_line(line.substr(0, line.size() - 1));
  if (!record) throw std::runtime_error("a record of another process arrived torn or altered");
  keep(std::move(*record), line);
}

void Journal::keep(JournalRecord record, std::string_view line) {
  const std::scoped_lock lock(keeping_);
  if (path_.empty()) {
    records_.push_back(std::move(record));
    return;
  }
  if (descriptor_ < 0) throw InvalidInput(fmt::format("{}: the journal was removed already", path_.string()));
  if (record.table.empty() || record.table.find_first_of(" \n") != std::string::npos) {
    throw InvalidInput(fmt::format("{}: table name '{}' must be one word", path_.string(), record.table));
  }
  write_whole(descriptor_, line, path_);
  records_.push_back(std::move(record));
  if (now() - last_sync_ < kSyncInterval) return;
  ::fdatasync(descriptor_);
  last_sync_ = now();
}

void Journal::remove() {
  if (descriptor_ < 0) return;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  ::close(std::exchange(descriptor_, -1));
}

void Journal::publish(const std::filesystem::path& path) {
  std::vector<const JournalRecord*> order;
  for (const JournalRecord& record : records_) order.push_back(&record);
  std::ranges::sort(order, {}, [](const JournalRecord* one) { return std::tie(one->table, one->index, one->note); });
  std::string text = header_of(fingerprint_);
  for (const JournalRecord* record : order) text += to_line(*record);
  write_renamed(path, text);
  remove();
}

JournalText Journal::read(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) {
    throw InvalidInput(fmt::format("{}: cannot be read ({})", path.string(), std::strerror(errno)));
  }
  const std::string text = read_all(file.get());
  const std::size_t end = text.find('\n');
  if (!text.starts_with(kMagic) || end == std::string::npos) {
    throw InvalidInput(fmt::format("{}: is neither a journal nor a part; choose another file", path.string()));
  }
  return records_in(text, end + 1);
}

std::filesystem::path Journal::path_for(const std::filesystem::path& result) { return result.string() + ".journal"; }

std::string fingerprint(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return fmt::format("{:016x}", hash);
}

}  // namespace slipmode::results
