#include <slipmode/studies/special_curves.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/numbers.hpp>
#include <slipmode/core/parallel.hpp>
#include <slipmode/results/provenance.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace slipmode::studies {
namespace {

using orbits::BranchPoint;
using orbits::SpecialKind;
using orbits::SpecialPoint;

constexpr std::array kFollowed = {SpecialKind::kFold, SpecialKind::kPeriodDoubling, SpecialKind::kGrazing,
                                  SpecialKind::kSymmetryBreaking, SpecialKind::kNeimarkSacker};

/// As it is said on a command line.
std::string word_of(SpecialKind kind) {
  std::string word = orbits::to_string(kind);
  std::ranges::transform(word, word.begin(), [](char c) {
    return c == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  return word;
}

/// A branch that turns back at a grazing passes a grazing there.
bool is_of(const SpecialPoint& point, SpecialKind kind) {
  return point.kind == kind || (kind == SpecialKind::kGrazing && point.kind == SpecialKind::kNonSmoothFold);
}

/// True where a curve passes a special point of the first key at a value of the second: between two of its points,
/// nearer to their chord than a curve that turns by 26° at most gets, which is what a step may do, and the orbits
/// alike.
bool passes(const orbits::Branch& curve, const SpecialPoint& point, const ContinuationRequest& over,
            const CurveRequest& along, double value) {
  constexpr double kSagitta = 0.06, kRounding = 1e-7;
  const auto trace_of = [](const orbits::PeriodicOrbit& orbit) { return orbit.multipliers.sum().real(); };
  const double range = std::abs(over.to - over.from), own = std::abs(along.to - along.from),
               trace = trace_of(point.orbit);
  for (std::size_t k = 1; k < curve.points.size(); ++k) {
    const BranchPoint &a = curve.points[k - 1], &b = curve.points[k];
    const double before = a.parameter - value, after = b.parameter - value;
    if (before * after > 0.0 || before == after || a.orbit.order != point.orbit.order) continue;
    const double one = trace_of(a.orbit), other = trace_of(b.orbit);
    const double alike = std::abs(other - one) + 1e-2 * (1.0 + std::abs(trace));
    const bool jumps = along.kind == SpecialKind::kGrazing;  // from one side of a grazing to the other
    if (!jumps && std::max(std::abs(one - trace), std::abs(other - trace)) > 2.0 * alike) continue;
    const double way = *b.other - *a.other, off = *a.other + way * before / (before - after) - point.parameter;
    if (std::abs(off) <= kSagitta * range * std::hypot(way / range, (after - before) / own) + kRounding * range)
      return true;
  }
  return false;
}

std::vector<const SpecialPoint*> points_of(const std::vector<results::NamedBranch>& branches,
                                           const CurveRequest& curve) {
  std::vector<const SpecialPoint*> found;
  for (const results::NamedBranch& branch : branches)
    for (const SpecialPoint& point : branch.branch.special)
      if (is_of(point, curve.kind)) found.push_back(&point);
  if (!curve.near || found.empty()) return found;
  const auto off = [&](const SpecialPoint* point) { return std::abs(point->parameter - *curve.near); };
  return {*std::ranges::min_element(found, {}, off)};
}

}  // namespace

std::vector<std::string> followed_words() {
  std::vector<std::string> words;
  words.reserve(kFollowed.size());
  for (const SpecialKind kind : kFollowed) words.push_back(word_of(kind));
  return words;
}

void read_point(const std::string& text, CurveRequest& out_request) {
  const std::size_t colon = text.find(':');
  const auto kind = std::ranges::find(kFollowed, text.substr(0, colon), word_of);
  if (kind == kFollowed.end())
    throw InvalidInput(
        fmt::format("--point {}: valid: {}, alone or with the value of --over it is nearest to, {}:VALUE", text,
                    fmt::join(followed_words(), ", "), word_of(kFollowed.front())));
  out_request.kind = *kind;
  out_request.near.reset();
  if (colon == std::string::npos) return;
  out_request.near = number_in<double>(text.substr(colon + 1));
  if (!out_request.near || !std::isfinite(*out_request.near))
    throw InvalidInput(fmt::format("--point {}: '{}' is not a number", text, text.substr(colon + 1)));
}

std::string point_text(const CurveRequest& request) {
  return word_of(request.kind) + (request.near ? fmt::format(":{}", *request.near) : "");
}

CurvePlane curve_plane(const scene::Scene& scene, const std::string& key, const std::optional<pod::NamedBasis>& basis,
                       const ContinuationRequest& request, const CurveRequest& curve) {
  if (curve.along == key)
    throw InvalidInput(fmt::format("--along {}: is the key of --over; name a second one", curve.along));
  const double own = scene::get_continuous_key(scene, curve.along);
  const auto [low, high] = std::minmax(curve.from, curve.to);
  const double along = low <= own && own <= high ? own : curve.from;
  const scene::Scene there = along == own ? scene : scene::set_key(scene, curve.along, along);
  CurvePlane plane{there, Family(there, {key, curve.along}, basis), along};
  for (const double end : {curve.from, curve.to}) {
    (void)scene::set_key(there, curve.along, end);
    (void)plane.family.at({request.from, end});
  }
  return plane;
}

SpecialCurves special_curves(const CurvePlane& plane, std::vector<results::NamedBranch> branches, double start,
                             const ContinuationRequest& request, const CurveRequest& curve,
                             const orbits::ShootingOptions& shooting, const RunOptions& run) {
  SpecialCurves out{.branches = std::move(branches), .start = start, .along = plane.along};
  const orbits::ContinuationOptions options{.from = curve.from,
                                            .to = curve.to,
                                            .step = request.step,
                                            .max_step = request.max_step,
                                            .max_points = request.max_points,
                                            .shooting = shooting};
  out.interrupted = is_interrupted(out.branches);
  for (const SpecialPoint* point : points_of(out.branches, curve)) {
    if (out.interrupted) break;
    const auto followed = [&](const results::NamedBranch& other) {
      return passes(other.branch, *point, request, curve, plane.along);
    };
    if (std::ranges::any_of(out.curves, followed)) continue;
    const std::string title = fmt::format("{} at {:.8g}", orbits::to_string(point->kind), point->parameter);
    try {
      out.curves.push_back({title, orbits::continue_special(
                                       [&plane, &run](double over, double value) {
                                         run.check_interrupt();
                                         return plane.family.at({over, value});
                                       },
                                       *point, plane.along, {request.from, request.to}, options)});
      out.interrupted = is_interrupted(out.curves);
    } catch (const InvalidInput& refused) {
      out.refused.emplace_back(refused.what());
    } catch (const Interrupted&) {
      out.interrupted = true;  // before this one was begun
    }
  }
  return out;
}

void require_no_certificate(const BalanceSearch& search) {
  if (search.certify || search.error)
    throw InvalidInput(
        "--certify, --error: not of curves by balance, as beside a fold there may be no orbit; give --harmonics a "
        "number, and see how far the curve moves with it, or beside the exact one by shooting");
}

Family plane_of(const scene::Scene& scene, const std::string& key, const std::optional<pod::NamedBasis>& basis,
                const CurveRequest& curve, const SpecialCurves& found) {
  return Family(scene::set_key(scene::set_key(scene, key, found.start), curve.along, found.along), {key, curve.along},
                basis);
}

std::string nothing_followed(const SpecialCurves& found, const std::string& key, const ContinuationRequest& request,
                             const CurveRequest& curve) {
  if (!found.curves.empty()) return {};
  if (!found.refused.empty()) return fmt::format("{}", fmt::join(found.refused, "; "));
  std::vector<std::string> others;
  for (const results::NamedBranch& branch : found.branches)
    for (const SpecialPoint& point : branch.branch.special)
      others.push_back(fmt::format("{} at {:.8g}", orbits::to_string(point.kind), point.parameter));
  const orbits::Branch& main = found.branches.front().branch;
  const bool whole = main.end == orbits::BranchEnd::kRange;
  return fmt::format("no {} of {} between {} and {} with {} = {}: the branch has {}{}", orbits::to_string(curve.kind),
                     key, request.from, request.to, curve.along, found.along,
                     others.empty() ? "no special point there" : fmt::format("{}", fmt::join(others, ", ")),
                     whole ? "; widen --over" : "; it ends early: " + main.reason);
}

std::string command_of(const std::string& continuation, const CurveRequest& curve) {
  return fmt::format("{} --along {}={}:{} --point {}", continuation, curve.along, curve.from, curve.to,
                     point_text(curve));
}

results::Content content_of(const Family& model, std::shared_ptr<const SpecialCurves> found, const std::string& command,
                            const RunOptions& run) {
  return {.kind = results::FileKind::kCurves,
          .unit_system = model.scene().units,
          .write = [model, run, found = std::move(found),
                    provenance = results::provenance_of(model.scene(), command)](results::StoreWriter& writer) {
            results::save(writer, provenance);
            results::store_curves(writer, model.keys(), found->curves, [&](double over, double along) {
              run.check_interrupt();
              return model.at({over, along});
            });
          }};
}

}  // namespace slipmode::studies
