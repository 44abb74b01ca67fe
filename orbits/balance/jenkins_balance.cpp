#include "orbits/balance/internal/jenkins_balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace slipmode::orbits {
namespace {

using dynamics::ContactMode;
constexpr double kRound = 2.0 * std::numbers::pi;

struct TurningPoint {
  double theta, y;
};

std::vector<TurningPoint> turning_points(const TrigonometricPolynomial& y) {
  const TrigonometricPolynomial slope = derivative(y);
  std::vector<TurningPoint> out;
  if (slope.phasors.isZero(0.0)) return out;
  for (const double theta : zeros(slope)) out.push_back({theta, y.at(theta).y});
  return out;
}

/// The slider's place, and where it was set.
struct Slider {
  double place = 0.0;
  std::optional<double> held_at = {};

  /// @return  −1, 1: it was moved up, down, λ at its lower, upper limit; 0: it stays
  int follow(const BalancedJenkins& law, double y, double theta) {
    const double low = y - law.lower / law.stiffness, high = y + law.upper / law.stiffness;
    const int slide = place < low ? -1 : place > high ? 1 : 0;
    if (slide != 0) {
      place = slide < 0 ? low : high;
      held_at = theta;
    }
    return slide;
  }
};

ContactMode mode_of(const JenkinsSpan& span) {
  return span.slide == 0  ? ContactMode::kStick
         : span.slide > 0 ? ContactMode::kSlipPositive
                          : ContactMode::kSlipNegative;
}

void add_exact(const BalancedJenkins& law, const TrigonometricPolynomial& y, BalancedForce& out_force) {
  const Eigen::Index H = y.phasors.size() - 1;
  LinearPiece sticks{.stiffness = law.stiffness, .set = Eigen::VectorXcd::Zero(2 * H + 1)};
  const std::vector<JenkinsSpan> spans = law.spans(y);
  for (const JenkinsSpan& span : spans) {
    const Eigen::VectorXcd set = arc_moments(span.begin, span.end, span.slide == 0 ? 2 * H : H);
    if (span.slide != 0) {
      add_constant(span.slide > 0 ? law.upper : -law.lower, set, out_force);
      continue;
    }
    sticks.set += set;
    add_constant(law.stiffness * span.place, set, out_force);
    if (span.held_at) add_following(law.stiffness, *span.held_at, set, out_force);
  }
  add_linear(y, sticks, out_force);
  out_force.stuck = spans.size() == 1;
  for (std::size_t i = 0; i < spans.size(); ++i)
    out_force.switches += spans[i].slide != spans[(i + 1) % spans.size()].slide;
}

void add_sampled(const BalancedJenkins& law, const TrigonometricPolynomial& y, int samples, BalancedForce& out_force) {
  const Eigen::Index H = y.phasors.size() - 1, N = samples;
  const std::vector<std::complex<double>> turns = sample_turns(samples);
  const auto theta = [&](Eigen::Index n) { return kRound * static_cast<double>(n) / static_cast<double>(N); };
  std::vector<double> values;
  for (Eigen::Index n = 0; n < N; ++n) values.push_back(y.at(theta(n)).y);
  Slider slider;
  int before = 0;
  for (Eigen::Index n = 0; n < N; ++n) before = slider.follow(law, values[static_cast<std::size_t>(n)], theta(n));
  LinearPiece sticks{.stiffness = law.stiffness, .set = Eigen::VectorXcd::Zero(2 * H + 1)};
  std::map<double, Eigen::VectorXcd> held;  // samples by what they follow
  out_force.stuck = true;
  for (Eigen::Index n = 0; n < N; ++n) {
    const int slide = slider.follow(law, values[static_cast<std::size_t>(n)], theta(n));
    out_force.switches += slide != before;
    out_force.stuck = out_force.stuck && slide == 0;
    before = slide;
    Eigen::VectorXcd here(2 * H + 1);
    for (Eigen::Index m = 0; m <= 2 * H; ++m)
      here[m] = turns[static_cast<std::size_t>(m * n % N)] / static_cast<double>(N);
    if (slide != 0) {
      add_constant(slide > 0 ? law.upper : -law.lower, here, out_force);
      continue;
    }
    sticks.set += here;
    add_constant(law.stiffness * slider.place, here, out_force);
    if (slider.held_at) held.try_emplace(*slider.held_at, Eigen::VectorXcd::Zero(2 * H + 1)).first->second += here;
  }
  for (const auto& [held_at, set] : held) add_following(law.stiffness, held_at, set, out_force);
  add_linear(y, sticks, out_force);
}

}  // namespace

BalancedJenkins BalancedJenkins::at_share(double share) const { return {stiffness, upper / share, lower / share}; }

std::vector<JenkinsSpan> BalancedJenkins::spans(const TrigonometricPolynomial& y) const {
  const std::vector<TurningPoint> turns = turning_points(y);
  Slider slider;
  if (turns.empty()) {  // at rest
    slider.follow(*this, y.at(0.0).y, 0.0);
    return {{.begin = 0.0, .end = kRound, .slide = 0, .place = slider.place, .held_at = slider.held_at}};
  }
  const std::size_t count = turns.size();
  for (std::size_t i = 1; i <= count; ++i) slider.follow(*this, turns[i % count].y, turns[i % count].theta);
  std::vector<JenkinsSpan> out;
  const double first = turns.front().theta;
  double begin = first;
  for (std::size_t i = 0; i < count; ++i) {
    const TurningPoint& next = turns[(i + 1) % count];
    const double end = i + 1 < count ? next.theta : first + kRound;
    const Slider before = slider;
    const int slide = slider.follow(*this, next.y, next.theta);
    if (slide == 0) continue;
    TrigonometricPolynomial way = y;  // to the limit; falls below it where the slider is drawn down
    way.phasors[0] -= before.place + (slide < 0 ? lower : -upper) / stiffness;
    const double onset = zero_between(way, turns[i].theta, slide < 0, end);
    out.push_back({begin, onset, 0, before.place, before.held_at});
    out.push_back({onset, end, slide, 0.0, {}});
    begin = end;
  }
  if (begin < first + kRound) out.push_back({begin, first + kRound, 0, slider.place, slider.held_at});
  return out;
}

BalancedForce BalancedJenkins::force(const TrigonometricPolynomial& y, double /*omega*/, int samples,
                                     const Orders& leading) const {
  BalancedForce out(y.phasors.size() - 1, leading);
  if (samples == kExact)
    add_exact(*this, y, out);
  else
    add_sampled(*this, y, samples, out);
  return out;
}

Passage BalancedJenkins::passage(const TrigonometricPolynomial& y, double /*omega*/) const {
  Passage out;
  const std::vector<JenkinsSpan> all = spans(y);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const JenkinsSpan& span = all[i];
    if (span.begin == 0.0 || (span.begin <= kRound && span.end > kRound)) out.first = mode_of(span);
    const bool changes = span.slide != all[(i + all.size() - 1) % all.size()].slide;
    if (changes) out.switches.push_back({std::fmod(span.begin, kRound), mode_of(span)});
  }
  std::ranges::sort(out.switches, {}, &Passage::Switch::theta);
  return out;
}

double BalancedJenkins::stretch(const TrigonometricPolynomial& y) const {
  const std::vector<JenkinsSpan> all = spans(y);
  const double zero = all.front().begin == 0.0 ? 0.0 : kRound;
  const auto here =
      std::ranges::find_if(all, [&](const JenkinsSpan& span) { return span.begin <= zero && zero < span.end; });
  const JenkinsSpan& span = here == all.end() ? all.back() : *here;
  if (span.slide != 0) return (span.slide > 0 ? upper : -lower) / stiffness;
  return span.place - y.at(0.0).y;
}

}  // namespace slipmode::orbits
