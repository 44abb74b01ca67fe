#include "diagnostics/exponents/internal/tangent_walk.hpp"

#include <slipmode/diagnostics/model.hpp>
#include "diagnostics/exponents/internal/tangent_frame.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

namespace slipmode::diagnostics {
namespace {

using dynamics::ContactMode;
using dynamics::Event;
using dynamics::EventKind;

/// Directions that contract more within a piece are followed to the flow's tolerance only: the piece is halved.
constexpr double kContraction = 1e-4;
/// Pieces are not made shorter than this share of the interval: what is lost within one is lost by an event.
constexpr double kShortest = 1.0 / 65536.0;
/// What pieces leave below this share of one is rounding, and run along with it: forces solved in it alone are noise.
constexpr double kSliver = 1e-6;
/// Distance kept from events, in units of the fastest frequency's radian.
constexpr double kMargin = 1e-5;

bool changes_volume(const Event& event) {
  return event.kind == EventKind::kStick || event.kind == EventKind::kRelease || event.kind == EventKind::kReversal;
}

bool is_event_of_modes(const Event& event) {
  return event.kind != EventKind::kGrazing && event.kind != EventKind::kDriveCorner;
}

/// The first column that is not among the first `kept` of those that remain.
Eigen::Index first_missing(const std::vector<Eigen::Index>& columns, Eigen::Index kept) {
  Eigen::Index k = 0;
  while (k < kept && columns[static_cast<std::size_t>(k)] == k) ++k;
  return k;
}

Eigen::Index directions_of(const dynamics::HybridSystem& system) { return 2 * system.size() + system.internal_size(); }

}  // namespace

Eigen::Index confined(const dynamics::HybridSystem& system, const std::vector<ContactMode>& modes) {
  Eigen::Index count = 0;
  for (std::size_t c = 0; c < modes.size(); ++c) {
    const bool compliant = friction::kind(system.contacts()[c].law) == friction::LawKind::kCompliant;
    const bool slides = std::abs(static_cast<int>(modes[c])) == 1 || modes[c] == ContactMode::kSeparated;
    if (compliant ? slides : modes[c] == ContactMode::kStick) ++count;
  }
  return count;
}

TangentWalk::TangentWalk(const dynamics::HybridSystem& system, const dynamics::State& start,
                         const TangentOptions& options)
    : system_(system),
      metric_(system),
      flow_(system, options.flow),
      options_(options.flow),
      interval_(options.interval),
      longest_(options.interval),
      shortest_(options.interval),
      margin_(kMargin / metric_.fastest()) {
  options_.audit = false;
  const Eigen::Index N = directions_of(system);
  const Eigen::Index count = options.exponents == 0 ? N : options.exponents;
  Random random(options.seed);
  const dynamics::TangentResult begun = flow_.run(start, 0.0, {.start = metric_.leave(random_frame(N, count, random))});
  state_ = begun.end;
  lost_ = confined(system, state_.modes);
  frame_ = orthonormalise(metric_.enter(begun.monodromy)).directions;
  frame_.conservativeResize(Eigen::NoChange, std::min(frame_.cols(), N - lost_));
  growth_ = Eigen::VectorXd::Zero(count);
  if (count < N || !PhaseVolume::applies(system)) return;
  volume_.emplace(system);
  balance_.emplace();
}

void TangentWalk::clear_balance() {
  if (balance_) balance_ = VolumeBalance{};
}

std::vector<Event> TangentWalk::push(double duration) {
  std::vector<Event> events;
  dropped_ = -1;
  const double end = state_.time + duration;
  const double rounding = 4e-16 * std::abs(end);
  for (double left = duration; left > rounding; left = end - state_.time) {
    const double piece = left < (1.0 + kSliver) * longest_ ? left : longest_;
    const dynamics::TangentResult result = flow_.run(state_, piece, {.start = metric_.leave(frame_)});
    std::vector<ContactMode> modes = state_.modes;
    Eigen::Index most = confined(system_, modes);
    for (const Event& event : result.events) {
      if (event.contact >= 0) modes[static_cast<std::size_t>(event.contact)] = event.after;
      // Behind a contact spring a jump of the contact point passes through sliding.
      most = std::max(most, confined(system_, modes) + (event.kind == EventKind::kJump ? 1 : 0));
    }
    most = std::max(most, confined(system_, result.end.modes));
    // In a frame that gets directions back those lost earlier are no longer missing.
    const Eigen::Index missing = volume_ ? most : std::max(lost_, most);
    const Eigen::Index expected = std::min(frame_.cols(), directions_of(system_) - missing);
    const Orthonormalised next = orthonormalise(metric_.enter(result.monodromy));
    const Eigen::Index kept = std::min(next.directions.cols(), expected);
    const double least = kept > 0 ? next.log_growth.head(kept).minCoeff() : 0.0;
    const bool contracted = kept < expected || least < std::log(kContraction);
    if (contracted && piece > kShortest * interval_) {
      longest_ = 0.5 * piece;
      continue;
    }
    shortest_ = std::min(shortest_, longest_);
    if (contracted || least > 0.25 * std::log(kContraction)) longest_ = std::min(interval_, 2.0 * longest_);
    if (kept < frame_.cols()) dropped_ = first_missing(next.columns, kept);
    frame_ = next.directions.leftCols(kept);
    growth_.head(kept) += next.log_growth.head(kept);
    lost_ = std::max(lost_, kept < expected ? directions_of(system_) - kept : most);
    state_ = result.end;
    events.insert(events.end(), result.events.begin(), result.events.end());
  }
  return events;
}

std::optional<Event> TangentWalk::next_event(double within) const {
  std::optional<Event> found;
  dynamics::SimulateOptions run{.duration = within,
                                .keep_events = false,
                                .output = dynamics::SimulateOptions::Output::kContacts,
                                .flow = options_};
  run.on_event = [&found](const Event& event, const dynamics::State&) {
    if (!is_event_of_modes(event)) return true;
    found = event;
    return false;
  };
  static_cast<void>(dynamics::simulate(system_, state_, run));
  return found;
}

void TangentWalk::quiet(double duration) {
  const PhaseContraction part = volume_->along(state_, duration, options_);
  balance_->viscous += part.viscous;
  balance_->friction += part.friction;
  push(duration);
}

void TangentWalk::offer(const Eigen::VectorXd& normal) {
  const Eigen::Index lasting = directions_of(system_) - lost_, given_back = frame_.cols() - lasting;
  if (given_back < 2) return;
  auto extra = frame_.rightCols(given_back);
  Eigen::VectorXd axis = (extra.transpose() * normal).normalized();
  if (!axis.allFinite()) return;
  // Householder's reflection that swaps the axis and the last column, the sign without cancellation.
  if (axis[given_back - 1] > 0.0) axis = -axis;
  axis[given_back - 1] -= 1.0;
  axis.normalize();
  const Eigen::VectorXd along = extra * axis;
  extra -= 2.0 * along * axis.transpose();
}

void TangentWalk::append(const Eigen::VectorXd& normal) {
  Eigen::VectorXd rest = normal;
  for (int pass = 0; pass < 2; ++pass) rest -= frame_ * (frame_.transpose() * rest);
  const double length = rest.norm();
  // What survives leaves the sticking space with its volume divided by the cosine between the two normals.
  balance_->events -= std::log(length);
  frame_.conservativeResize(Eigen::NoChange, frame_.cols() + 1);
  frame_.rightCols(1) = rest / length;
}

void TangentWalk::cross(double duration) {
  const std::vector<ContactMode> before = state_.modes;
  const dynamics::State just_before = state_;
  const Eigen::MatrixXd frame = frame_;
  const std::vector<Event> events = push(duration);
  // A direction that had lasted is gone, though one that slip gave back is left: it takes its place in the frame only.
  if (dropped_ >= 0 && dropped_ < directions_of(system_) - lost_) ++lost_;
  const auto relevant = std::ranges::count_if(events, changes_volume);
  if (relevant == 1) {
    const Event event = *std::ranges::find_if(events, changes_volume);
    if (event.kind == EventKind::kStick && dropped_ >= 0) {
      const Eigen::VectorXd normal = metric_.enter(volume_->normal(before, event.contact));
      balance_->events += std::log(std::abs(normal.dot(frame.col(dropped_))));
    } else if (event.kind == EventKind::kRelease) {
      append(metric_.enter(volume_->normal(state_.modes, event.contact)));
    } else if (event.kind == EventKind::kReversal) {
      dynamics::State at = just_before;
      at.modes = state_.modes;
      balance_->events += volume_->reversal(at, event.contact, event.before);
    }
  }
  if (relevant > 1 || frame_.cols() != directions_of(system_) - confined(system_, state_.modes))
    ++balance_->unexplained;
}

void TangentWalk::advance_to(double time) {
  growth_.setZero();
  if (!volume_) {
    push(time - state_.time);
    return;
  }
  const double rounding = 4e-16 * std::abs(time);
  for (double left = time - state_.time; left > rounding; left = time - state_.time) {
    const std::optional<Event> event = next_event(left);
    if (!event) {
      quiet(left);
      continue;
    }
    const double reach = event->time - state_.time;
    if (reach > 2.0 * margin_) quiet(reach - margin_);
    if (event->kind == EventKind::kStick) offer(metric_.enter(volume_->normal(state_.modes, event->contact)));
    cross(event->time + margin_ - state_.time);
  }
}

}  // namespace slipmode::diagnostics
