#include "cli/session.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <memory>
#include <utility>

namespace slipmode::cli {

namespace fs = std::filesystem;

namespace {

/// One line per batch of work, each with its own time left.
class BatchLines {
 public:
  BatchLines(std::string label, ProgressMode mode)
      : label_(std::move(label)), mode_(mode), line_(std::make_unique<ProgressLine>(label_, mode)) {}

  void update(std::size_t done, std::size_t total) {
    if (total_ != 0 && (total != total_ || done < done_)) {
      line_.reset();  // ends the line before the next one begins
      line_ = std::make_unique<ProgressLine>(label_, mode_);
    }
    done_ = done;
    total_ = total;
    line_->update(done, total);
  }

 private:
  std::string label_;
  ProgressMode mode_;
  std::unique_ptr<ProgressLine> line_;
  std::size_t done_ = 0, total_ = 0;
};

}  // namespace

studies::RunOptions Session::run_options() const {
  return {
      .threads = threads, .stop = stop, .progress = [mode = progress_mode(), share = shard](const std::string& part) {
        const auto lines = std::make_shared<BatchLines>(
            share ? fmt::format("{}, shard {}", part, results::to_string(*share)) : part, mode);
        return [lines](std::size_t done, std::size_t total) { lines->update(done, total); };
      }};
}

studies::Division Session::division() const {
  return {.shard = shard, .joined = joined, .words = words, .ranks = ranks};
}

scene::Scene Session::load(const fs::path& path) const {
  if (!joined.empty()) {
    const scene::SceneSource& source = joined.front().head.scene;
    return scene::parse_scene(source.text, source.overrides, source.path);
  }
  std::vector<std::string> all = overrides;
  if (seed) all.push_back(fmt::format("ensemble.seed={}", *seed));
  return scene::load_scene(path, all);
}

void Session::refuse_overrides(const std::string& verb, const std::string& why) const {
  if (!overrides.empty()) throw InvalidInput(fmt::format("{}: --set has no use here, {}", verb, why));
}

bool is_among(const std::string& output, const std::vector<std::string>& inputs) {
  return std::ranges::any_of(inputs, [&output](const std::string& input) {
    std::error_code none;
    return std::filesystem::equivalent(input, output, none);
  });
}

void tell_file(const std::string& what, const std::string& file, Report& out_report) {
  if (file.empty()) return;
  out_report.data["file"] = file;
  out_report.text += fmt::format("{}: {}\n", what, file);
}

void tell_resumed(const Session& session, std::size_t resumed, const std::string& what, Report& out_report) {
  out_report.data["resumed"] = resumed;
  if (resumed == 0) return;
  out_report.text +=
      fmt::format("{} {} were taken over from {}\n", resumed, what,
                  session.joined.empty() ? "an interrupted run" : fmt::format("{} parts", session.joined.size()));
}

Report part_made(const Session& session, const studies::FileProgress& done, const std::string& output,
                 const std::string& what) {
  Report report;
  if (!session.shard) return report;
  report.text = fmt::format("Shard {}: {} {}\n", results::to_string(session.shard.value()), done.finished, what);
  report.data = {{"shard", results::to_string(session.shard.value())}, {"file", output}, {what, done.finished}};
  tell_resumed(session, done.resumed, what, report);
  report.text += fmt::format("Part: {}; 'slipmode merge PART... -o FILE' joins all of them\n", output);
  return report;
}

std::string certificate(const dynamics::FlowStatistics& statistics) {
  return fmt::format("certified {} of {} steps", statistics.certified, statistics.steps);
}

}  // namespace slipmode::cli
