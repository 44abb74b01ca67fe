#include <slipmode/results/part.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/core/numbers.hpp>
#include <slipmode/results/provenance.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

namespace slipmode::results {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHeadTable = "#part";  // before all others in a part, which is sorted

PartHead head_in(const JournalRecord& record, const fs::path& path) {
  constexpr std::size_t kMostParts = 10'000'000;  // as many as a sweep has values
  try {
    const auto json = nlohmann::json::parse(record.note);
    PartHead head{
        .shard = {.number = json.at("shard"), .count = json.at("of")},
        .version = json.at("version"),
        .rounding = json.at("rounding"),
        .command = json.at("command"),
        .words = json.at("words"),
        .scene = {.path = json.at("scene_path"), .text = json.at("scene_text"), .overrides = json.at("overrides")}};
    const auto& [number, count] = head.shard;
    if (count >= 1 && number <= count && count <= kMostParts) return head;
    throw InvalidInput(fmt::format("{}: its head says shard {}; make it anew", path.string(), to_string(head.shard)));
  } catch (const nlohmann::json::exception& error) {
    throw InvalidInput(fmt::format("{}: its head cannot be read ({}); make it anew", path.string(), error.what()));
  }
}

std::string command_line(const PartHead& head, const Shard& shard, const std::string& output) {
  std::string line = "slipmode";
  for (const std::string& word : head.words) line += " " + shell_word(word);
  return fmt::format("{} --shard {} -o {}", line, to_string(shard), shell_word(output));
}

/// Where two resolved scenes begin to differ.
std::string scene_difference(const PartHead& one, const PartHead& other) {
  const auto text_of = [](const PartHead& head) {
    return scene::scene_to_toml(scene::parse_scene(head.scene.text, head.scene.overrides, head.scene.path));
  };
  std::istringstream first(text_of(one)), second(text_of(other));
  std::string a, b;
  for (;;) {
    const bool more_a = static_cast<bool>(std::getline(first, a)), more_b = static_cast<bool>(std::getline(second, b));
    if (!more_a && !more_b) return "";
    if (more_a != more_b || a != b)
      return fmt::format("its scene has '{}' where the other has '{}'", more_b ? b : "nothing", more_a ? a : "nothing");
  }
}

/// Why `part` does not belong to the study of `first`.
std::string difference(const Part& first, const Part& part) {
  const PartHead &a = first.head, &b = part.head;
  if (a.version != b.version) return fmt::format("made by slipmode {}, the other by {}", b.version, a.version);
  if (a.command != b.command) return fmt::format("made by '{}', the other by '{}'", b.command, a.command);
  const std::string scenes = scene_difference(a, b);
  return scenes.empty() ? "the files that its command reads were others" : scenes;
}

}  // namespace

std::string rounding() { return std::string(kernels::kernels().name) == "generic" ? "generic" : "fused"; }

Shard parse_shard(const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto number = number_in<std::size_t>(text.substr(0, slash));
  const auto count = number_in<std::size_t>(text.substr(std::min(slash + 1, text.size())));
  if (number && count && *number >= 1 && *number <= *count) return {.number = *number, .count = *count};
  throw InvalidInput(fmt::format(
      "--shard {}: expected I/N with I = 1 ... N, e.g. --shard 1/4 to --shard 4/4, one process each", text));
}

std::string to_string(const Shard& shard) { return fmt::format("{}/{}", shard.number, shard.count); }

std::string shard_fingerprint(const std::string& fingerprint, const Shard& shard) {
  return fmt::format("{}-{}", fingerprint, to_string(shard));
}

JournalRecord to_record(const PartHead& head) {
  const nlohmann::ordered_json json = {{"shard", head.shard.number},    {"of", head.shard.count},
                                       {"version", head.version},       {"rounding", head.rounding},
                                       {"command", head.command},       {"words", head.words},
                                       {"scene_path", head.scene.path}, {"overrides", head.scene.overrides},
                                       {"scene_text", head.scene.text}};
  try {
    return {.table = kHeadTable, .index = 0, .values = {}, .note = json.dump()};
  } catch (const nlohmann::json::type_error&) {
    throw InvalidInput(
        fmt::format("--shard {}: a part keeps the command and the scene, which are not UTF-8 here; rename "
                    "what is not",
                    to_string(head.shard)));
  }
}

Part read_part(const fs::path& path) {
  const bool finished = fs::exists(path);
  const fs::path file = finished ? path : Journal::path_for(path);
  if (!fs::exists(file)) {
    throw InvalidInput(
        fmt::format("{}: there is no such part, nor a journal of it; check the name, or compute it", path.string()));
  }
  JournalText text = Journal::read(file);
  const bool written = file.extension() == ".journal";  // may be torn at its end
  Part part{.path = written ? fs::path(file).replace_extension() : path, .fingerprint = "", .head = {}, .records = {}};
  const bool has_head = !text.records.empty() && text.records.front().table == kHeadTable;
  if (!has_head && !text.damaged) {
    throw InvalidInput(fmt::format("{}: {}", file.string(),
                                   written ? "holds no part's head; run its shard again"
                                           : "is no part of a study; parts are what --shard I/N leaves"));
  }
  if (has_head) part.head = head_in(text.records.front(), file);
  if (text.damaged && !(written && has_head)) {
    throw InvalidInput(
        fmt::format("{}: damaged at byte {} (a record is torn or altered); remove it and compute it anew{}",
                    file.string(), text.whole, part.head.words.empty() ? "" : ":\n  " + command_line(part)));
  }
  part.fingerprint = text.fingerprint.substr(0, text.fingerprint.find('-'));
  part.records.assign(std::make_move_iterator(text.records.begin() + 1), std::make_move_iterator(text.records.end()));
  return part;
}

std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./%@";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

void check_parts(const std::vector<Part>& parts) {
  if (parts.empty()) throw InvalidInput("merge: expected the parts of a study, found none");
  const Part& first = parts.front();
  std::vector<const Part*> found(first.head.shard.count, nullptr);
  for (const Part& part : parts) {
    const auto& [number, count] = part.head.shard;
    if (number == 0)
      throw InvalidInput(fmt::format("{}: has no share of the values; leave it out", part.path.string()));
    if (part.head.rounding != rounding()) {  // first: a model made here by other kernels is another one
      throw InvalidInput(fmt::format(
          "{}: computed with {} kernels, which round differently from the {} ones here; set "
          "SLIPMODE_KERNELS={}, or compute it anew here",
          part.path.string(), part.head.rounding, rounding(), part.head.rounding == "fused" ? "avx2" : "generic"));
    }
    if (part.fingerprint != first.fingerprint) {
      throw InvalidInput(fmt::format("{}: is of another study than {}: {}; merge parts of one study",
                                     part.path.string(), first.path.string(), difference(first, part)));
    }
    if (count != found.size()) {
      throw InvalidInput(fmt::format("{}: is shard {}, {} is shard {}: of another number; merge parts of one division",
                                     part.path.string(), to_string(part.head.shard), first.path.string(),
                                     to_string(first.head.shard)));
    }
    if (found[number - 1] != nullptr) {
      throw InvalidInput(fmt::format("{}: is shard {}, as {} is; give each once", part.path.string(),
                                     to_string(part.head.shard), found[number - 1]->path.string()));
    }
    found[number - 1] = &part;
  }
  if (first.head.version != version()) {
    throw InvalidInput(
        fmt::format("{}: made by slipmode {}, this is {}; merge with that one, or compute the parts anew",
                    first.path.string(), first.head.version, version()));
  }
  std::string missing;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found[k] != nullptr) continue;
    const Shard shard{.number = k + 1, .count = found.size()};
    missing += fmt::format("\n  {}", command_line(first.head, shard, fmt::format("PART{}", shard.number)));
  }
  if (missing.empty()) return;
  throw InvalidInput(fmt::format("{} of {} parts are missing; give them, or compute them:{}",
                                 std::ranges::count(found, nullptr), found.size(), missing));
}

std::string command_line(const Part& part) { return command_line(part.head, part.head.shard, part.path.string()); }

}  // namespace slipmode::results
