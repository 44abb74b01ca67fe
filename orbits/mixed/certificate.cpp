#include <slipmode/orbits/mixed/certificate.hpp>

#include <slipmode/core/errors.hpp>
#include "orbits/balance/internal/trigonometric.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

namespace slipmode::orbits {
namespace {

/// Farther from the series than this share of a half range, an orbit is another one.
constexpr double kBehind = 0.25;
/// Of the whole motion: what moves by less sticks.
constexpr double kStill = 1e-12;

/// Displacements and velocities of the contacts at equal distances over a period [nc x points].
struct Samples {
  double start = 0.0, period = 0.0;
  Eigen::MatrixXd y, v;
};

Samples samples_of(const OrbitSeries& orbit, double start, double period, int points) {
  const Eigen::Index nc = orbit.contacts();
  Samples out{start, period, Eigen::MatrixXd(nc, points), Eigen::MatrixXd(nc, points)};
  for (int k = 0; k < points; ++k) {
    const Eigen::VectorXd now = orbit.at(start + period * k / points);
    out.y.col(k) = now.head(nc);
    out.v.col(k) = now.segment(nc, nc);
  }
  return out;
}

/// The largest error over its contact's half range.
double largest_share(const std::vector<double>& error, const std::vector<double>& half) {
  double share = 0.0;
  for (std::size_t c = 0; c < error.size(); ++c)
    if (error[c] > 0.0) share = std::max(share, error[c] / half[c]);
  return share;
}

/// A motion that an orbit is to lie behind.
struct Claim {
  const char* name;
  int crossings = 0;
  int points = 0;  ///< at which it is compared
  std::function<Samples(double start, double period, int points)> samples;
};

/// Between them an error of the first order left out is a cubic to 0.02 % of itself (h⁴/384), and one that comes of a
/// jump of the third derivative to 0.6 % (h³/192 beside 1/(3πH³)).
int points_for(int harmonics) { return std::max(500, 13 * harmonics); }

Claim claim_of(const Balance& balance) {
  std::vector<TrigonometricPolynomial> series;
  for (const Harmonics& y : balance.displacement) series.push_back(polynomial_of(y));
  return {"balance", balance.switches, points_for(balance.harmonics),
          [series = std::move(series), omega = balance.omega](double start, double period, int points) {
            const auto nc = std::ssize(series);
            Samples out{start, period, Eigen::MatrixXd(nc, points), Eigen::MatrixXd(nc, points)};
            for (Eigen::Index c = 0; c < nc; ++c) {
              const TrigonometricPolynomial& own = series[static_cast<std::size_t>(c)];
              out.y.row(c) = values_around(own, omega * start, points);
              out.v.row(c) = omega * values_around(derivative(own), omega * start, points);
            }
            return out;
          }};
}

Claim claim_of(const MixedOrbit& mixed) {
  return {"mixed orbit", mixed.near_orbit.crossings, points_for(mixed.harmonics),
          [series = OrbitSeries(*mixed.near_system, mixed.near_orbit)](double start, double period, int points) {
            return samples_of(series, start, period, points);
          }};
}

/// The largest size on [0, 1] of the cubic with these values and slopes at the ends, if larger than `most`.
double larger_of_cubic(double most, double y0, double slope0, double y1, double slope1) {
  constexpr double kBetween = 4.0 / 27.0;  // the most that a slope alone adds
  most = std::max({most, std::abs(y0), std::abs(y1)});
  if (std::max(std::abs(y0), std::abs(y1)) + kBetween * (std::abs(slope0) + std::abs(slope1)) <= most) return most;
  const double third = slope0 + slope1 - 2.0 * (y1 - y0), second = y1 - y0 - slope0 - third;
  const double a = 3.0 * third, b = 2.0 * second, discriminant = b * b - 4.0 * a * slope0;
  if (discriminant < 0.0) return most;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  for (const double s : {q / a, slope0 / q})
    if (s > 0.0 && s < 1.0) most = std::max(most, std::abs(y0 + s * (slope0 + s * (second + s * third))));
  return most;
}

/// sup over the period of the distance of each contact's displacements.
std::vector<double> distances(const Claim& claim, const Samples& orbit) {
  const Eigen::Index points = orbit.y.cols();
  const Samples other = claim.samples(orbit.start, orbit.period, static_cast<int>(points));
  const Eigen::MatrixXd error = orbit.y - other.y;
  const Eigen::MatrixXd slope = (orbit.period / static_cast<double>(points)) * (orbit.v - other.v);
  std::vector<double> largest;
  for (Eigen::Index c = 0; c < error.rows(); ++c) {
    double most = error.row(c).cwiseAbs().maxCoeff();
    for (Eigen::Index k = 0; k < points; ++k) {
      const Eigen::Index next = k + 1 < points ? k + 1 : 0;
      most = larger_of_cubic(most, error(c, k), slope(c, k), error(c, next), slope(c, next));
    }
    largest.push_back(most);
  }
  return largest;
}

/// An orbit that motions are measured by.
class OrbitBehind {
 public:
  OrbitBehind(const dynamics::HybridSystem& system, PeriodicOrbit orbit) : system_(system), orbit_(std::move(orbit)) {}

  /// At so many points: one run over the period from its start, an origin within the first.
  [[nodiscard]] const Samples& samples(int points) {
    if (samples_.y.cols() == points) return samples_;
    dynamics::State start = orbit_.start;
    start.time = std::fmod(start.time, orbit_.period);
    const dynamics::Trajectory run = simulate(system_, start,
                                              {.duration = orbit_.period,
                                               .sample = orbit_.period / points,
                                               .keep_events = false,
                                               .output = dynamics::SimulateOptions::Output::kContacts,
                                               .flow = {.tolerance = 1e-13, .audit = false}});
    samples_ = {start.time, orbit_.period, run.contact_q.leftCols(points), run.contact_v.leftCols(points)};
    return samples_;
  }

  [[nodiscard]] std::vector<double> half_ranges(const Samples& at) const {
    constexpr double kSuspect = 1e-6;
    std::vector<double> half;
    for (const auto& y : at.y.rowwise()) half.push_back(0.5 * (y.maxCoeff() - y.minCoeff()));
    const double seen = std::max(orbit_.start.q.cwiseAbs().maxCoeff(), *std::ranges::max_element(half));
    if (*std::ranges::min_element(half) > kSuspect * seen) return half;
    const double size = size_of_motion(system_, orbit_);
    for (double& own : half)  // of a contact that never moves: the whole motion's size
      if (own < kStill * size) own = size;
    return half;
  }

 private:
  const dynamics::HybridSystem& system_;
  PeriodicOrbit orbit_;
  Samples samples_;
};

void judge(const Claim& claim, OrbitBehind& behind, Certificate& out) {
  const Samples& orbit_samples = behind.samples(claim.points);
  out.error = distances(claim, orbit_samples);
  out.relative = largest_share(out.error, behind.half_ranges(orbit_samples));
  out.behind = out.relative <= kBehind;
  const PeriodicOrbit& orbit = out.found.orbit;
  if (!out.behind) {
    out.verdict = fmt::format(
        "no orbit lies behind this {}: Newton's shooting from it ends on the orbit \"{}\", {:.3g} of a half range away",
        claim.name, abridged(orbit.word), out.relative);
    return;
  }
  out.verdict = fmt::format("true error {:.3g} of a half range; the orbit behind it is \"{}\", {}", out.relative,
                            abridged(orbit.word), to_string(orbit.stability));
  if (orbit.crossings != claim.crossings)
    out.verdict += fmt::format("; it has {} crossings and the {} {}", orbit.crossings, claim.name, claim.crossings);
}

/// @param out_behind  what shooting from the state ends on, near or not; empty where it does not end
Certificate shoot_behind(const dynamics::HybridSystem& system, const dynamics::State& state, int order,
                         const Claim& claim, const ShootingOptions& options, std::optional<OrbitBehind>& out_behind) {
  ShootingOptions at_order = options;
  at_order.order = order;
  Certificate out;
  out.found = shoot(system, state, at_order);
  out_behind.reset();
  if (!out.found.converged()) {
    out.verdict = fmt::format("no orbit lies behind this {}: {}", claim.name, out.found.message);
    return out;
  }
  out_behind.emplace(system, out.found.orbit);
  judge(claim, *out_behind, out);
  return out;
}

Certificate distance_from(const ShootingResult& known, const Claim& claim, const dynamics::HybridSystem& system) {
  Certificate out;
  out.found = known;
  OrbitBehind behind(system, known.orbit);
  judge(claim, behind, out);
  return out;
}

/// @param first  order @param solve  of an order, from the best so far that has an orbit behind, or nullptr
template <class Approximation, class Solve>
ToError<Approximation> to_error(const dynamics::HybridSystem& system, double error, int first, int most,
                                const ShootingOptions& shooting, const Solve& solve) {
  if (!(error > 0.0 && std::isfinite(error)))
    throw InvalidInput(fmt::format("error: {}; valid: a number > 0, a share of the half range", error));
  constexpr double kGrowth = 1.3;
  ToError<Approximation> out, best;
  std::optional<OrbitBehind> behind;
  const auto look = [&] {  // the orbit of an order before serves as long as it is near and no other is beside it
    const Claim claim = claim_of(out.approximation);
    if (behind) judge(claim, *behind, out.certificate);
    if (behind && out.certificate.behind) return;
    out.certificate =
        shoot_behind(system, state_of(system, out.approximation), out.approximation.order, claim, shooting, behind);
    const PeriodicOrbit& found =
        out.certificate.found.orbit;  // neighbours of a family that curves are told by a 1 alone
    if (found.family.cols() > 0 || found.stability == Stability::kMarginal) behind.reset();
  };
  for (int H = first; H <= most && !out.met; H = std::max(H + 1, static_cast<int>(kGrowth * H))) {
    out.approximation = solve(H, best.certificate.behind ? &best.approximation : nullptr);
    OrderTrial trial{
        .harmonics = H, .iterations = out.approximation.iterations, .error = std::numeric_limits<double>::quiet_NaN()};
    if (out.approximation.converged) {
      look();
      if (out.certificate.behind) trial.error = out.certificate.relative;
    }
    out.trials.push_back(trial);
    out.met = trial.error <= error;
    if (trial.error >= 0.0 && !(trial.error > best.certificate.relative && best.certificate.behind)) best = out;
  }
  if (out.met || !best.certificate.behind) return out;
  best.trials = std::move(out.trials);
  return best;
}

}  // namespace

std::vector<double> true_errors(const Balance& balance, const OrbitSeries& orbit) {
  const Claim claim = claim_of(balance);
  return distances(claim, samples_of(orbit, orbit.start(), orbit.period(), claim.points));
}

Certificate certify(const dynamics::HybridSystem& system, const Balance& balance, const ShootingOptions& options) {
  std::optional<OrbitBehind> behind;
  return shoot_behind(system, state_of(system, balance), balance.order, claim_of(balance), options, behind);
}

Certificate certify(const dynamics::HybridSystem& system, const MixedOrbit& mixed, const ShootingOptions& options) {
  std::optional<OrbitBehind> behind;
  return shoot_behind(system, state_of(system, mixed), mixed.order, claim_of(mixed), options, behind);
}

Certificate compare(const dynamics::HybridSystem& system, const Balance& balance, const ShootingResult& known) {
  return distance_from(known, claim_of(balance), system);
}

Certificate compare(const dynamics::HybridSystem& system, const MixedOrbit& mixed, const ShootingResult& known) {
  return distance_from(known, claim_of(mixed), system);
}

CertifiedBalance balance_to_error(const dynamics::HybridSystem& system, BalanceOptions options, double error, int most,
                                  const ShootingOptions& shooting) {
  constexpr int kFirst = 3;
  return to_error<Balance>(system, error, kFirst, most, shooting, [&](int harmonics, const Balance* before) {
    options.harmonics = harmonics;
    if (before != nullptr) options.guess = before->displacement;
    Balance next = balance(system, options);
    if (!next.converged && !options.guess.empty()) {
      options.guess.clear();
      next = balance(system, options);
    }
    return next;
  });
}

CertifiedMixed mixed_to_error(const dynamics::HybridSystem& system, MixedOptions options, double error, int most,
                              const ShootingOptions& shooting) {
  const int first = least_harmonics(system, options);
  return to_error<MixedOrbit>(system, error, first, most, shooting, [&](int harmonics, const MixedOrbit* before) {
    options.harmonics = harmonics;
    if (before != nullptr) options.guess = MixedStart{before->near_orbit.start, before->coupling};
    return mixed_orbit(system, options);
  });
}

}  // namespace slipmode::orbits
