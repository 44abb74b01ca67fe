#include <slipmode/report/report.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/file_kind.hpp>
#include <slipmode/results/part.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/scene/driven.hpp>
#include "report/internal/answers.hpp"
#include "report/internal/assets.hpp"
#include "report/internal/file_content.hpp"
#include "report/internal/linked.hpp"

#include <fmt/format.h>
#include <zlib.h>
#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace slipmode::report {
namespace {

namespace fs = std::filesystem;
using results::FileKind;
using results::shell_word;
using results::StoreReader;

/// The result files in a folder, in the order of their names; HDF5 files of other programs are passed over.
std::vector<StoreReader> stores_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().extension() == ".h5") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::vector<StoreReader> stores;
  for (const fs::path& file : files) {
    StoreReader store(file);
    if (results::kind_of(store)) stores.push_back(std::move(store));
  }
  if (stores.empty())
    throw InvalidInput(
        fmt::format("{}: no result file (*.h5) in it; 'slipmode run SCENE -o DIR' leaves some", folder.string()));
  return stores;
}

/// Folders as the files in them, a comparison before all others.
std::vector<StoreReader> stores_of(const std::vector<fs::path>& inputs) {
  std::vector<StoreReader> stores;
  for (const fs::path& input : inputs) {
    if (fs::is_directory(input)) {
      std::ranges::move(stores_in(input), std::back_inserter(stores));
    } else {
      stores.emplace_back(input);
    }
  }
  std::stable_partition(stores.begin(), stores.end(),
                        [](const StoreReader& store) { return results::kind_of(store) == FileKind::kValidation; });
  return stores;
}

const StoreReader* first_of(const std::vector<StoreReader>& stores, FileKind kind) {
  const auto found = std::ranges::find(stores, kind, [](const StoreReader& store) { return results::kind_of(store); });
  return found == stores.end() ? nullptr : &*found;
}

/// The first that says where it came from.
const StoreReader* first_with_provenance(const std::vector<StoreReader>& stores) {
  const auto found = std::ranges::find_if(stores, [](const StoreReader& store) { return store.has("provenance"); });
  return found == stores.end() ? nullptr : &*found;
}

/// Files side by side, of the same scene.
bool belong_together(const StoreReader& a, const StoreReader& b) {
  if (fs::absolute(a.path()).parent_path() != fs::absolute(b.path()).parent_path()) return false;
  if (!a.has("provenance") || !b.has("provenance")) return false;
  const results::Provenance one = results::load_provenance(a), other = results::load_provenance(b);
  return one.scene_path == other.scene_path && one.overrides == other.overrides;
}

/// Of `slipmode run` every word is known; other verbs keep what they computed, not all they started from.
bool is_of_run(const std::vector<StoreReader>& stores) {
  const StoreReader* run = first_of(stores, FileKind::kTrajectory);
  return run != nullptr && run->has("provenance") && results::load_provenance(*run).command == "slipmode run" &&
         std::ranges::all_of(stores, [run](const StoreReader& store) { return belong_together(*run, store); });
}

std::string command_of(const StoreReader& own, bool of_run) {
  const results::Provenance provenance = results::load_provenance(own);
  std::string words = (of_run ? "slipmode run" : provenance.command) + " " + shell_word(provenance.scene_path);
  for (const std::string& set : provenance.overrides) words += " --set " + shell_word(set);
  const fs::path made = of_run ? fs::absolute(own.path()).parent_path() : own.path();
  return words + " -o " + shell_word(made.filename().string());
}

Json document(const std::vector<StoreReader>& stores) {
  const StoreReader* own = first_with_provenance(stores);
  const bool of_run = is_of_run(stores);
  Json out = {{"version", results::version()},
              {"commit", results::git_commit()},
              {"command", own == nullptr ? std::string() : command_of(*own, of_run)},
              {"repeats", of_run}};
  out["title"] = stores.front().path().filename().string();
  out["answers"] = Json::array();
  if (own != nullptr) {
    const scene::Scene scene = results::load_scene_of(*own);
    if (!scene.title.empty()) out["title"] = scene.title;
    out["units"] = scene.units;
    out["answers"].push_back({{"question", "What was modelled?"}, {"answer", model_text(scene)}, {"tone", "plain"}});
  }
  const StoreReader* validation = first_of(stores, FileKind::kValidation);
  if (validation != nullptr && validation->has("validation/shares")) {
    for (Json& one : belt_answers(*validation)) out["answers"].push_back(std::move(one));
  }
  if (validation != nullptr && validation->has("shaken_validation/agreement")) {
    for (Json& one : driven_answers(*validation)) out["answers"].push_back(std::move(one));
  }
  const StoreReader* pod = first_of(stores, FileKind::kPod);
  out["files"] = Json::array();
  for (const StoreReader& store : stores)
    out["files"].push_back(file_json(store, !(pod != nullptr && results::kind_of(store) == FileKind::kReduced)));
  return out;
}

/// Apart from the document: the first screen does not wait for them.
Json motions_of(const std::vector<StoreReader>& stores, const studies::RunOptions& run) {
  const StoreReader* validation = first_of(stores, FileKind::kValidation);
  const StoreReader* pod = first_of(stores, FileKind::kPod);
  const bool linked = validation != nullptr && pod != nullptr && belong_together(*validation, *pod);
  return linked ? linked_motions(*validation, *pod, run) : Json(nullptr);
}

std::string deflated(const std::string& text) {
  uLongf size = compressBound(text.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(text.data()), text.size(),
                Z_BEST_COMPRESSION) != Z_OK)
    throw std::runtime_error("zlib: out of memory");
  out.resize(size);
  return out;
}

std::string base64(const std::string& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(4 * (bytes.size() / 3 + 1));
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) { return k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0U; };
    const unsigned word = byte(i) << 16U | byte(i + 1) << 8U | byte(i + 2);
    for (unsigned k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[word >> (18U - 6U * k) & 63U] : '=';
  }
  return out;
}

std::string packed(const Json& content) {
  return base64(deflated(content.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

/// Text as it is in HTML.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

/// The template with each @NAME@ of it filled in, once, from left to right: what is filled in is not looked at again.
std::string filled(std::string_view text, const std::vector<std::pair<std::string_view, std::string_view>>& parts) {
  std::string out;
  for (const auto& [name, value] : parts) {
    const std::size_t at = text.find(name);
    out.append(text.substr(0, at)).append(value);
    text.remove_prefix(at + name.size());
  }
  return out.append(text);
}

}  // namespace

bool is_available() { return !kD3.empty(); }

void require_available() {
  if (is_available()) return;
  throw InvalidInput(
      "this build has no report: it was built without D3; install Debian's node-d3, then configure and build again");
}

std::string page(const std::vector<fs::path>& inputs, const studies::RunOptions& run) {
  require_available();
  const std::vector<StoreReader> stores = stores_of(inputs);
  const Json content = document(stores);
  const std::string data = packed(content), motions = packed(motions_of(stores, run));
  const std::string title = escaped(content["title"].get<std::string>()), licence = escaped(kD3Licence);
  return filled(kTemplate, {{"@TITLE@", title},
                            {"@STYLE@", kStyle},
                            {"@LICENCE@", licence},
                            {"@DATA@", data},
                            {"@MOTIONS@", motions},
                            {"@D3@", kD3},
                            {"@SCRIPT@", kScript}});
}

}  // namespace slipmode::report
