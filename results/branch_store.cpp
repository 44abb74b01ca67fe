#include <slipmode/results/branch_store.hpp>

#include <slipmode/results/file_kind.hpp>
#include "results/internal/field_record.hpp"

#include <fmt/format.h>
#include <limits>

namespace slipmode::results {
namespace {

using orbits::BranchPoint;

template <class Get>
std::vector<double> gather(const std::vector<BranchPoint>& points, Get get) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const BranchPoint& point : points) values.push_back(get(point));
  return values;
}

/// Of a branch's or a special point: of its series where it is a balance. @param family  over (other, parameter)
template <class Point>
std::vector<orbits::Amplitude> amplitudes_of(const Point& point, const dynamics::PlaneFamily& family) {
  return point.balance ? orbits::contact_amplitudes(*point.balance)
                       : orbits::contact_amplitudes(family(point.other.value_or(0.0), point.parameter), point.orbit);
}

/// Columns of the contacts' displacements: "alternating_1" and so on.
std::vector<Column> amplitude_columns(const std::vector<BranchPoint>& points, const dynamics::PlaneFamily& family) {
  std::vector<std::vector<orbits::Amplitude>> all;
  all.reserve(points.size());
  for (const BranchPoint& point : points) all.push_back(amplitudes_of(point, family));
  std::vector<Column> columns;
  const std::size_t contacts = all.empty() ? 0 : all.front().size();
  for (std::size_t c = 0; c < contacts; ++c) {
    for (Column& column : columns_of(
             all, [c](const std::vector<orbits::Amplitude>& sizes) -> const auto& { return sizes[c]; })) {
      column.name += fmt::format("_{}", c + 1);
      column.meaning.description += fmt::format(" {}", c + 1);
      columns.push_back(std::move(column));
    }
  }
  return columns;
}

/// Where a point lies: its values of the keys, by the names of their columns.
struct KeyColumns {
  std::vector<std::string> keys;  ///< of curves the other one first

  template <class Point>
  [[nodiscard]] std::vector<Column> of(const std::vector<Point>& points) const {
    std::vector<double> parameter, other;
    for (const Point& point : points) {
      parameter.push_back(point.parameter);
      other.push_back(point.other.value_or(0.0));
    }
    if (keys.size() == 1) return {{"parameter", {"", keys[0]}, parameter}};
    return {{"over", {"", keys[0]}, other}, {"along", {"", keys[1]}, parameter}};
  }
};

Table point_table(const KeyColumns& place, const std::vector<BranchPoint>& points,
                  const dynamics::PlaneFamily& family) {
  const auto add = [&points](const char* name, const char* units, const char* what, auto get) {
    return Column{name, {units, what}, gather(points, get)};
  };
  std::vector<std::string> stability, words;
  for (const BranchPoint& point : points) {
    stability.emplace_back(orbits::to_string(point.orbit.stability));
    words.push_back(point.orbit.word);
  }
  Table table{.description = "orbits in order along the branch", .columns = {}};
  const std::vector<Column> own = {
      add("arclength", "1", "along the branch, scaled", [](const BranchPoint& p) { return p.arclength; }),
      add("period", "s", "period", [](const BranchPoint& p) { return p.orbit.period; }),
      add("leading_modulus", "1", "largest |multiplier| without trivial ones; NaN: not judged",
          [](const BranchPoint& p) {
            const bool judged = p.orbit.stability != orbits::Stability::kUnknown;
            return judged ? p.orbit.leading_modulus : std::numeric_limits<double>::quiet_NaN();
          }),
      {"stability", {"", "stability"}, stability},
      add("crossings", "", "events that change a force law", [](const BranchPoint& p) { return p.orbit.crossings; }),
      add("symmetric", "", "1: x(T/2) = -x(0)", [](const BranchPoint& p) { return p.orbit.symmetric ? 1.0 : 0.0; }),
      add("family", "", "parameters of the family it is one of",
          [](const BranchPoint& p) { return static_cast<double>(p.orbit.family.cols()); }),
      add("residual", "1", "mismatch after a period", [](const BranchPoint& p) { return p.orbit.residual; }),
      {"word", {"", "regimes"}, words}};
  table.columns = joined({place.of(points), own});
  for (Column& column : amplitude_columns(points, family)) table.columns.push_back(std::move(column));
  if (!points.empty() && points.front().balance)
    table.columns.push_back(add("true_error", "m",
                                "sup |y - exact| of the first contact; NaN: not looked at, infinite: no orbit behind",
                                [](const BranchPoint& p) { return p.true_error; }));
  return table;
}

Table special_table(const KeyColumns& place, const orbits::Branch& branch, const dynamics::PlaneFamily& family) {
  std::vector<std::string> kind;
  std::vector<double> before, real, imaginary, amplitude;
  for (const orbits::SpecialPoint& point : branch.special) {
    kind.emplace_back(orbits::to_string(point.kind));
    before.push_back(static_cast<double>(point.before));
    real.push_back(point.multiplier.real());
    imaginary.push_back(point.multiplier.imag());
    amplitude.push_back(amplitudes_of(point, family).front().alternating);
  }
  return {.description = "points where the branch changes its kind",
          .columns = joined(
              {{{"kind", {"", "what happens"}, kind}, {"before", {"", "row of `points` it follows, from 0"}, before}},
               place.of(branch.special),
               columns_of(branch.special),
               {{"multiplier", {"1", "the critical one, real part"}, real},
                {"multiplier_imaginary", {"1", "its imaginary part"}, imaginary},
                {"alternating", {"m", "half the range of the first contact's displacement"}, amplitude}}})};
}

/// Multipliers of all points: a row each, real parts, then imaginary ones.
Eigen::MatrixXd multiplier_rows(const std::vector<BranchPoint>& points) {
  if (points.empty()) return {};
  const Eigen::Index n = points.front().orbit.multipliers.size();
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(points.size()), 2 * n);
  for (Eigen::Index k = 0; k < rows.rows(); ++k) {
    const Eigen::VectorXcd& own = points[static_cast<std::size_t>(k)].orbit.multipliers;
    rows.row(k) << own.real().transpose(), own.imag().transpose();
  }
  return rows;
}

/// Starting states of all points, a row each: displacements, then velocities.
Eigen::MatrixXd start_rows(const std::vector<BranchPoint>& points) {
  if (points.empty()) return {};
  const Eigen::Index n = points.front().orbit.start.q.size();
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(points.size()), 2 * n);
  for (Eigen::Index k = 0; k < rows.rows(); ++k) {
    const dynamics::State& start = points[static_cast<std::size_t>(k)].orbit.start;
    rows.row(k) << start.q.transpose(), start.v.transpose();
  }
  return rows;
}

/// Coefficients of all balances' displacements, a row each: contact after contact cosines of orders 0 to H, sines of 1
/// to H.
Eigen::MatrixXd coefficient_rows(const std::vector<BranchPoint>& points) {
  const Eigen::Index H = points.front().balance->harmonics, contacts = std::ssize(points.front().balance->displacement);
  Eigen::MatrixXd rows(std::ssize(points), contacts * (2 * H + 1));
  for (Eigen::Index k = 0; k < rows.rows(); ++k)
    for (Eigen::Index c = 0; c < contacts; ++c) {
      const orbits::Harmonics& y =
          points[static_cast<std::size_t>(k)].balance->displacement[static_cast<std::size_t>(c)];
      rows.row(k).segment(c * (2 * H + 1), 2 * H + 1) << y.cosine.transpose(), y.sine.tail(H).transpose();
    }
  return rows;
}

/// Each branch in a sub-group of its own.
void store_all(StoreWriter& writer, const std::string& all, const KeyColumns& place,
               const std::vector<NamedBranch>& branches, const dynamics::PlaneFamily& family) {
  for (std::size_t k = 0; k < branches.size(); ++k) {
    const auto& [title, branch] = branches[k];
    const std::string group = fmt::format("{}/{}", all, k);
    writer.describe_group(group, "one branch");
    writer.write(group + "/title", title, {"", "which branch"});
    writer.write(group + "/end", std::string(orbits::to_string(branch.end)), {"", "why it ends"});
    writer.write(group + "/reason", branch.reason, {"", "the same in a sentence"});
    save(writer, group + "/points", point_table(place, branch.points, family));
    save(writer, group + "/special", special_table(place, branch, family));
    writer.write(group + "/multipliers", multiplier_rows(branch.points),
                 {"1", "Floquet multipliers, point x (real parts, imaginary parts)"});
    writer.write(group + "/start", start_rows(branch.points),
                 {"", "where each orbit starts, point x (displacements, velocities)"});
    if (branch.points.empty() || !branch.points.front().balance) continue;
    writer.write(group + "/harmonics", static_cast<double>(branch.points.front().balance->harmonics),
                 {"", "highest order of the balances"});
    writer.write(
        group + "/coefficients", coefficient_rows(branch.points),
        {"m", "displacements of the contacts, point x (cosines of orders 0 to H, sines of 1 to H, each contact)"});
  }
}

/// What was stored under a group. @param made_by  the command that makes one
std::vector<StoredBranch> load_all(const StoreReader& store, const std::string& all, const std::string& made_by) {
  std::vector<StoredBranch> branches;
  for (std::size_t k = 0; store.has(fmt::format("{}/{}", all, k)); ++k) {
    const std::string group = fmt::format("{}/{}", all, k);
    StoredBranch branch{.title = store.text(group + "/title"),
                        .end = store.text(group + "/end"),
                        .reason = store.text(group + "/reason"),
                        .points = load_table(store, group + "/points"),
                        .special = load_table(store, group + "/special"),
                        .modulus = {}};
    const Eigen::MatrixXd parts = store.matrix(group + "/multipliers");
    const Eigen::Index n = parts.cols() / 2;
    branch.modulus = (parts.leftCols(n).array().square() + parts.rightCols(n).array().square()).sqrt();
    branches.push_back(std::move(branch));
  }
  if (branches.empty()) store.fail(all, fmt::format("the file holds none; make one with '{}'", made_by));
  return branches;
}

}  // namespace

void store_branches(StoreWriter& writer, const std::string& key, const std::vector<NamedBranch>& branches,
                    const dynamics::SystemFamily& family) {
  writer.describe_group("branches", "branches of periodic orbits over a parameter");
  writer.write("branches/key", key, {"", "the parameter: a key of the scene"});
  store_all(writer, "branches", {{key}}, branches, [&family](double, double value) { return family(value); });
}

void store_curves(StoreWriter& writer, const std::vector<std::string>& keys, const std::vector<NamedBranch>& curves,
                  const dynamics::PlaneFamily& family) {
  writer.describe_group("curves", "curves of special points over two parameters");
  writer.write("curves/over", keys.at(0), {"", "the first parameter: a key of the scene"});
  writer.write("curves/along", keys.at(1), {"", "the second one"});
  store_all(writer, "curves", {keys}, curves, family);
}

std::vector<StoredBranch> load_branches(const StoreReader& store) {
  return load_all(store, "branches", words_of(FileKind::kBranches).made_by);
}

std::vector<StoredBranch> load_curves(const StoreReader& store) {
  return load_all(store, "curves", words_of(FileKind::kCurves).made_by);
}

}  // namespace slipmode::results
