#include <slipmode/results/series_input.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/numbers.hpp>
#include <slipmode/diagnostics/attractors/farthest_dof.hpp>
#include <slipmode/results/csv_series.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/scene/scene.hpp>
#include "results/internal/seal.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

namespace slipmode::results {
namespace {

namespace fs = std::filesystem;

/// Samples with their instants, before any is left out.
struct RawRecord {
  Eigen::VectorXd times, values;
  std::string name, unit, time_unit = "unit";
};

struct FileAndSeries {
  std::string file, series;
};

/// At the first colon after which a file of that name exists: names of files may hold colons.
FileAndSeries file_and_series(const std::string& input) {
  for (std::size_t colon = input.find(':'); colon != std::string::npos; colon = input.find(':', colon + 1)) {
    if (fs::is_regular_file(input.substr(0, colon))) return {input.substr(0, colon), input.substr(colon + 1)};
  }
  if (!fs::is_regular_file(input)) {
    throw InvalidInput(fmt::format("'{}': no such file; expected FILE or FILE:SERIES", input));
  }
  return {input, ""};
}

Eigen::VectorXd equal_steps(Eigen::Index count, double interval) {
  return Eigen::VectorXd::LinSpaced(count, 0.0, static_cast<double>(count - 1) * interval);
}

/// Keeps from … to, every so many-th. `place(k)` says where sample k stands in the file.
template <typename Place>
SeriesInput stretch_of(const RawRecord& record, const SeriesRequest& request, const Place& place) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < record.times.size(); ++k) {
    if (!std::isfinite(record.times(k))) {
      throw InvalidInput(fmt::format("{}: expected an instant, found none at {}", record.name, place(k)));
    }
    if (record.times(k) < request.from.value_or(-INFINITY) || record.times(k) > request.to.value_or(INFINITY)) continue;
    if (!std::isfinite(record.values(k))) {
      throw InvalidInput(
          fmt::format("{}: expected a number, found none at {} (time {:g}); cut the record there with --from or --to",
                      record.name, place(k), record.times(k)));
    }
    kept.push_back(k);
  }
  if (kept.size() < 2) {
    throw InvalidInput(
        fmt::format("{}: expected at least 2 samples between --from and --to, found {}; instants run "
                    "from {:g} to {:g}",
                    record.name, kept.size(), record.times(0), record.times(record.times.size() - 1)));
  }
  SeriesInput out;
  try {
    out.series = diagnostics::uniform_series(record.times(kept), record.values(kept), record.name);
  } catch (const InvalidInput& uneven) {
    throw InvalidInput(fmt::format("{} (sample 0 is {}; --from and --to cut)", uneven.what(), place(kept.front())));
  }
  out.start = record.times(kept.front());
  out.series.unit = record.unit;
  out.series.time_unit = record.time_unit;
  if (request.every > 1) {
    const Eigen::Index count = (out.series.values.size() + request.every - 1) / request.every;
    const Eigen::VectorXd thinned = out.series.values(Eigen::seqN(0, count, request.every));
    out.series.values = thinned;
    out.series.interval *= static_cast<double>(request.every);
  }
  return out;
}

std::string named_unit(const std::string& unit) { return unit.empty() ? "1" : unit; }

SeriesInput read_csv(const FileAndSeries& source, const SeriesRequest& request) {
  const CsvFile file(source.file);
  const bool counts = request.interval > 0.0;
  const int time = !request.time.empty() ? static_cast<int>(file.column(request.time)) : file.time_column();
  if (time < 0 && !counts) {
    std::vector<std::string> names;
    for (const auto& name : file.names()) names.push_back(name.name);
    throw InvalidInput(
        fmt::format("'{}' has no column t or time; say which with --time, or how far samples are apart "
                    "with --interval (1 for a map); columns: {}",
                    source.file, fmt::join(names, ", ")));
  }
  std::vector<std::size_t> others;
  for (std::size_t k = 0; k < file.names().size(); ++k) {
    if (static_cast<int>(k) != time) others.push_back(k);
  }
  if (source.series.empty() && others.size() != 1) {
    std::vector<std::string> choices;
    choices.reserve(others.size());
    for (const std::size_t k : others) choices.push_back(fmt::format("{}:{}", source.file, file.names()[k].name));
    throw InvalidInput(fmt::format("'{}' has {} columns of samples; say which: {}", source.file, others.size(),
                                   fmt::join(choices, ", ")));
  }
  const std::size_t column = source.series.empty() ? others.front() : file.column(source.series);
  RawRecord record{.times = {}, .values = file.values(column), .name = {}, .unit = {}};
  if (record.values.size() < 2) {
    throw InvalidInput(
        fmt::format("'{}': expected samples below the header, found {}", source.file, record.values.size()));
  }
  record.times =
      counts ? equal_steps(record.values.size(), request.interval) : file.values(static_cast<std::size_t>(time));
  record.name = fmt::format("{}:{}", fs::path(source.file).filename().string(), file.names()[column].name);
  record.unit = named_unit(file.names()[column].unit);
  if (time >= 0 && !file.names()[static_cast<std::size_t>(time)].unit.empty()) {
    record.time_unit = file.names()[static_cast<std::size_t>(time)].unit;
  }
  SeriesInput out = stretch_of(record, request, [&](Eigen::Index k) { return fmt::format("line {}", file.line(k)); });
  out.what = fmt::format("column {} of {}", file.names()[column].name, source.file);
  return out;
}

/// A result file: where its records are, what they are called.
class RecordFile {
 public:
  RecordFile(StoreReader store, FileAndSeries source, const SeriesRequest& request)
      : source_(std::move(source)), request_(request), store_(std::move(store)) {
    if (!store_.has("provenance")) return;
    scene_ = load_scene_of(store_);
    const dynamics::HybridSystem system = scene::build_system(*scene_);
    names_ = system.structure().dof_names();
    farthest_ = diagnostics::farthest_dof(system);
    drive_period_ = system.drive().period().value_or(0.0);
  }

  SeriesInput read() const {
    const Choice choice = source_.series.empty() ? farthest() : chosen();
    const Eigen::MatrixXd all = samples(choice.dataset);
    if (choice.column >= all.cols()) {
      throw InvalidInput(fmt::format("{}: '{}' has columns 1 to {}, found {}", source_.file, choice.dataset, all.cols(),
                                     choice.column + 1));
    }
    const std::string label = all.cols() > 1 || store_.entry(choice.dataset).shape.size() > 1
                                  ? fmt::format("{}/{}", choice.dataset, choice.column + 1)
                                  : choice.dataset;
    RawRecord record = part_of(choice, all.col(choice.column));
    record.name = fmt::format("{}:{}", fs::path(source_.file).filename().string(), label);
    SeriesInput out = stretch_of(record, request_, [](Eigen::Index k) { return fmt::format("row {}", k); });
    out.drive_period = drive_period_;
    out.what = described(choice, label);
    if (const auto best = best_choice(); best && !is(*best, choice)) {
      out.smoother = fmt::format("{}:{}/{}", source_.file, best->dataset, best->column + 1);
    }
    return out;
  }

 private:
  struct Choice {
    std::string dataset;
    Eigen::Index column = 0;
  };

  static bool is(const Choice& a, const Choice& b) { return a.dataset == b.dataset && a.column == b.column; }

  /// A vector as one column.
  Eigen::MatrixXd samples(const std::string& dataset) const {
    if (store_.entry(dataset).shape.size() == 1) return store_.vector(dataset);
    return store_.matrix(dataset);
  }

  bool is_record(const std::string& name) const {
    if (!store_.has(name)) return false;
    const StoreEntry entry = store_.entry(name);
    return entry.kind == StoreEntry::Kind::kDouble && (entry.shape.size() == 1 || entry.shape.size() == 2);
  }

  std::optional<Choice> best_choice() const {
    if (!scene_) return std::nullopt;
    const std::string dataset = kind_of(store_) == FileKind::kEnsemble ? "ensemble/snapshots" : "trajectory/v";
    if (!is_record(dataset) || store_.entry(dataset).shape.back() <= farthest_) return std::nullopt;
    return Choice{dataset, farthest_};
  }

  Choice farthest() const {
    if (const auto best = best_choice()) return *best;
    std::vector<std::string> records;
    for (const StoreEntry& entry : store_.entries()) {
      constexpr std::int64_t kLeast = 100;
      if (is_record(entry.name) && entry.shape.front() >= kLeast) records.push_back(entry.name);
    }
    if (records.empty()) {
      throw InvalidInput(fmt::format(
          "'{}' holds no record of 100 samples or more ('slipmode info' says what is inside)", source_.file));
    }
    throw InvalidInput(fmt::format("'{}': say which record: {}:DATASET or {}:DATASET/COLUMN; there are {}",
                                   source_.file, source_.file, source_.file, fmt::join(records, ", ")));
  }

  /// The dataset a name means: as it stands, or in one of the groups where records are.
  std::optional<std::string> dataset_of(const std::string& name) const {
    for (const std::string& full :
         {name, "trajectory/" + name, "sensors/" + name, "ensemble/" + name, name + "/readings", name + "/snapshots"}) {
      if (is_record(full)) return full;
    }
    return std::nullopt;
  }

  Choice chosen() const {
    if (const auto dataset = dataset_of(source_.series)) return Choice{*dataset, 0};
    const std::size_t slash = source_.series.rfind('/');
    const std::string name = source_.series.substr(0, slash);
    const auto dataset = slash == std::string::npos ? std::nullopt : dataset_of(name);
    if (!dataset) {
      std::vector<std::string> records;
      for (const StoreEntry& entry : store_.entries()) {
        if (is_record(entry.name) && entry.shape.front() > 1) records.push_back(entry.name);
      }
      throw InvalidInput(
          fmt::format("'{}' has no record '{}'; there are {}", source_.file, source_.series, fmt::join(records, ", ")));
    }
    return {*dataset, column_of(*dataset, source_.series.substr(slash + 1))};
  }

  Eigen::Index column_of(const std::string& dataset, const std::string& word) const {
    const auto& shape = store_.entry(dataset).shape;
    const std::int64_t columns = shape.size() == 1 ? 1 : shape.back();
    const auto named = std::ranges::find(names_, word);
    if (named != names_.end() && static_cast<std::int64_t>(names_.size()) == columns) return named - names_.begin();
    const auto number = number_in<std::int64_t>(word);
    if (!number || *number < 1 || *number > columns) {
      throw InvalidInput(fmt::format("{}: '{}' has columns 1 to {}, found '{}'", source_.file, dataset, columns, word));
    }
    return *number - 1;
  }

  /// The samples with their instants; of an ensemble one member's.
  RawRecord part_of(const Choice& choice, const Eigen::VectorXd& values) const {
    const Units units = Units::of(scene_ ? scene_->units : "SI");
    RawRecord record{.times = {}, .values = values, .name = {}, .unit = unit_of(choice.dataset)};
    if (scene_ && units.time != "1") record.time_unit = units.time;
    if (choice.dataset == "ensemble/snapshots") {
      const auto begin = store_.integers("ensemble/run_begin");
      const auto members = static_cast<Eigen::Index>(begin.size());
      if (request_.member < 1 || request_.member > members) {
        throw InvalidInput(
            fmt::format("--member {}: '{}' has members 1 to {}", request_.member, source_.file, members));
      }
      const auto m = static_cast<std::size_t>(request_.member - 1);
      const Eigen::Index end = request_.member < members ? begin[m + 1] : values.size();
      record.values = values.segment(begin[m], end - begin[m]);
    }
    record.times = times_of(choice, record.values.size());
    return record;
  }

  Eigen::VectorXd times_of(const Choice& choice, Eigen::Index count) const {
    if (request_.interval > 0.0) return equal_steps(count, request_.interval);
    if (!request_.time.empty()) return store_.vector(request_.time, count);
    const std::string group = choice.dataset.substr(0, choice.dataset.rfind('/') + 1);
    for (const std::string& name : {group + "time", std::string("trajectory/time"), std::string("time")}) {
      if (is_record(name) && store_.entry(name).shape.front() == count) return store_.vector(name);
    }
    if (scene_ && choice.dataset == "ensemble/snapshots") return equal_steps(count, scene_->time.sample);
    throw InvalidInput(fmt::format("'{}' has no instants for '{}'; give a dataset with --time, or --interval",
                                   source_.file, choice.dataset));
  }

  std::string unit_of(const std::string& dataset) const {
    if (scene_ && scene_->units != "SI") return "1";
    return named_unit(store_.entry(dataset).meaning.units);
  }

  std::string described(const Choice& choice, const std::string& label) const {
    std::string text = fmt::format("{} of {}", label, source_.file);
    const bool by_dof = static_cast<std::int64_t>(names_.size()) == store_.entry(choice.dataset).shape.back();
    const bool of_motion =
        choice.dataset == "trajectory/v" || choice.dataset == "trajectory/q" || choice.dataset == "ensemble/snapshots";
    if (by_dof && of_motion) {
      text += fmt::format(": {} of {}", choice.dataset == "trajectory/v" ? "velocity" : "displacement",
                          names_[static_cast<std::size_t>(choice.column)]);
    }
    if (const auto best = best_choice(); best && is(*best, choice)) text += ", farthest from the contacts";
    if (choice.dataset == "ensemble/snapshots") text += fmt::format(", member {}", request_.member);
    return text;
  }

  FileAndSeries source_;
  const SeriesRequest& request_;
  StoreReader store_;
  std::optional<scene::Scene> scene_;
  std::vector<std::string> names_;
  Eigen::Index farthest_ = 0;
  double drive_period_ = 0.0;
};

}  // namespace

SeriesInput read_series(const std::string& input, const SeriesRequest& request) {
  const FileAndSeries source = file_and_series(input);
  return is_hdf5(source.file) ? RecordFile(StoreReader(source.file), source, request).read()
                              : read_csv(source, request);
}

SeriesInput read_series(StoreReader store, const std::string& series, const SeriesRequest& request) {
  const std::string name = store.path().string();
  return RecordFile(std::move(store), {name, series}, request).read();
}

SeriesInput series_of(const Eigen::VectorXd& values, const std::string& name, const SeriesRequest& request) {
  if (values.size() < 2)
    throw InvalidInput(fmt::format("{}: expected 2 samples or more, found {}", name, values.size()));
  const double interval = request.interval > 0.0 ? request.interval : 1.0;
  SeriesInput out =
      stretch_of({.times = equal_steps(values.size(), interval), .values = values, .name = name, .unit = "1"}, request,
                 [](Eigen::Index k) { return fmt::format("sample {}", k); });
  out.what = fmt::format("{} samples", values.size());
  return out;
}

}  // namespace slipmode::results
