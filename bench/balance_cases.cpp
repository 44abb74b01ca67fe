#include "bench/balance_cases.hpp"

#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/masses.hpp>
#include <slipmode/orbits/mixed/certificate.hpp>
#include "bench/balance_peer.hpp"
#include "bench/clock.hpp"

#include <fmt/format.h>
#include <functional>
#include <optional>

namespace slipmode::bench {
namespace {

using dynamics::HybridSystem;
using orbits::Balance;

constexpr int kSamples = 1024;

/// The same problem for both.
struct BalanceProblemCase {
  std::string name;
  PeerProblem peer;
  HybridSystem system;
  std::function<HybridSystem(double amplitude)> at;  ///< set: begun from a neighbour, at 0.99 of the amplitude
};

friction::Contact jenkins_at(Eigen::Index dof, Eigen::Index size, double limit, double stiffness) {
  return {Eigen::VectorXd::Unit(size, dof), friction::CompliantCoulomb{limit, limit, stiffness}, 1.0};
}

/// A mass on a spring and on one Jenkins element.
BalanceProblemCase rubbed_mass() {
  const fem::Structure structure = fem::masses({.links = {{.stiffness = 1.0, .damping = 0.05}}});
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  PeerProblem peer{.M = one, .C = 0.05 * one, .K = one, .elements = {{.reach = 0.3}}, .omega = 0.8, .amplitude = 0.7};
  return {.name = "rubbed mass",
          .peer = std::move(peer),
          .system = {structure, {jenkins_at(0, 1, 0.3, 1.0)}, friction::Force{0.8, {{.amplitude = 0.7}}}, {}, one},
          .at = nullptr};
}

/// S2's Figure 7(a): a mass between two stops.
BalanceProblemCase play() {
  const auto system = [](double amplitude) {
    const friction::Stop stop{.stiffness = 1.0, .gap = 1.0};
    return HybridSystem(fem::masses({.links = {{.damping = 0.04}}}),
                        {{Eigen::VectorXd::Ones(1), friction::Clearance{stop, stop, friction::ContactLoss::kGap}}},
                        friction::Force{1.0, {{.amplitude = amplitude}}}, {}, Eigen::MatrixXd::Ones(1, 1));
  };
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  PeerProblem peer{.M = one,
                   .C = 0.04 * one,
                   .K = 0.0 * one,
                   .elements = {{.kind = PeerElement::Kind::kPlay}},
                   .omega = 1.0,
                   .amplitude = 1.0833};
  return {.name = "play", .peer = std::move(peer), .system = system(1.0833), .at = system};
}

/// datasets/jenkins_chain: ten masses, two elements.
BalanceProblemCase rubbed_chain() {
  const fem::Structure structure = fem::chain({.masses = 10, .damping = 0.02});
  PeerProblem peer{.M = fem::to_dense(structure.M()),
                   .C = fem::to_dense(structure.C()),
                   .K = fem::to_dense(structure.K()),
                   .elements = {{.dof = 4, .reach = 0.3}, {.dof = 9, .stiffness = 0.5, .reach = 0.4}},
                   .driven = 9,
                   .omega = 0.3,
                   .amplitude = 0.4};
  return {.name = "rubbed chain",
          .peer = std::move(peer),
          .system = {structure,
                     {jenkins_at(4, 10, 0.3, 1.0), jenkins_at(9, 10, 0.2, 0.5)},
                     friction::Force{0.3, {{.amplitude = 0.4}}},
                     {},
                     Eigen::MatrixXd(Eigen::VectorXd::Unit(10, 9))},
          .at = nullptr};
}

/// Of both, from nothing or from a neighbour that has been found before.
class Pair {
 public:
  Pair(const BalanceProblemCase& own, const orbits::ShootingResult& orbit) : own_(own), orbit_(orbit) {}

  [[nodiscard]] Balance solve(int harmonics, int samples) const {
    return orbits::balance(own_.system, {.harmonics = harmonics, .samples = samples, .guess = near_});
  }
  /// What is begun from. @param harmonics  of both
  void prepare(int harmonics, const AlternatingScheme& scheme) {
    if (!own_.at) return;
    constexpr double kNear = 0.99;
    near_ = orbits::balance(own_.at(kNear * own_.peer.amplitude), {.harmonics = harmonics}).displacement;
    near_peer_.displacement = {near_.front()};
    PeerProblem there = own_.peer;
    there.amplitude *= kNear;
    near_peer_ = scheme.solve(there, near_peer_);
  }
  [[nodiscard]] PeerBalance solve(const AlternatingScheme& scheme) const {
    return own_.at ? scheme.solve(own_.peer, near_peer_) : scheme.solve(own_.peer);
  }

  [[nodiscard]] double error(const Balance& balance) const {
    return orbits::compare(own_.system, balance, orbit_).relative;
  }
  [[nodiscard]] double error(const PeerBalance& peer) const {
    Balance same;
    same.omega = own_.peer.omega;
    for (const PeerElement& element : own_.peer.elements)
      same.displacement.push_back(peer.displacement[static_cast<std::size_t>(element.dof)]);
    same.harmonics = static_cast<int>(same.displacement.front().order());
    return error(same);
  }

 private:
  const BalanceProblemCase& own_;
  const orbits::ShootingResult& orbit_;
  std::vector<orbits::Harmonics> near_;
  PeerBalance near_peer_;
};

/// The least order that is as near to the orbit.
std::optional<int> least_order(const Pair& pair, double error, int most) {
  for (int H = 1; H <= most; ++H) {
    const Balance own = pair.solve(H, 0);
    if (own.converged && pair.error(own) <= error) return H;
  }
  return std::nullopt;
}

void add_comparison(const BalanceProblemCase& problem, int harmonics, bool quick, Row& out_row) {
  constexpr int kWanted = 20;
  const std::unique_ptr<AlternatingScheme> scheme = alternating_scheme(harmonics, kSamples);
  if (!scheme) return;
  const Balance exact_start = orbits::balance(problem.system, {.harmonics = 49});
  const orbits::Certificate certificate = certify(problem.system, exact_start);
  Pair pair(problem, certificate.found);
  pair.prepare(harmonics, *scheme);
  PeerBalance peer = pair.solve(*scheme);
  const double error = pair.error(peer);
  const std::optional<int> order = least_order(pair, error, 2 * harmonics);
  if (!peer.converged || !order) {
    out_row.lines.push_back(
        fmt::format("{:>14} {:>8} no comparison: the scheme does not converge", problem.name, harmonics));
    return;
  }
  Balance own;
  const bool large = problem.peer.M.rows() > 1;
  const double theirs = median_seconds(large ? 3 : quick ? 21 : 201, [&] { peer = pair.solve(*scheme); });
  const double ours = median_seconds(quick ? 201 : 2001, [&] { own = pair.solve(*order, 0); });
  out_row.lines.push_back(
      fmt::format("{:>14} {:>8} {:>10.1e} {:>6} {:>12.0f} {:>8} {:>10.1e} {:>6} {:>12.1f} {:>8.1f} {:>8}", problem.name,
                  harmonics, error, peer.iterations, 1e6 * theirs, *order, pair.error(own), own.iterations, 1e6 * ours,
                  theirs / ours, kWanted));
  const std::string name = fmt::format("{}_{}", problem.name, harmonics);
  out_row.figures.emplace_back(name + "_fftw_us", 1e6 * theirs);
  out_row.figures.emplace_back(name + "_slipmode_us", 1e6 * ours);
  out_row.figures.emplace_back(name + "_ratio", theirs / ours);
  out_row.timed.push_back({.name = "balance " + name, .ms = 1e3 * ours, .error = error});
}

/// A balance of 49 harmonics from nothing, and its certificate, beside what is wanted.
void add_point(const BalanceProblemCase& problem, bool quick, Row& out_row) {
  Balance own;
  orbits::Certificate certificate;
  const int repeats = quick ? 201 : 2001;
  const double balance_seconds =
      median_seconds(repeats, [&] { own = orbits::balance(problem.system, {.harmonics = 49}); });
  const double certificate_seconds = median_seconds(repeats, [&] { certificate = certify(problem.system, own); });
  out_row.lines.push_back(fmt::format(
      "{:>14} 49 harmonics from nothing in {} steps: {:.0f} us (wanted 1000); certificate, true error {:.1e}: {:.0f} "
      "us "
      "(wanted 200)",
      problem.name, own.iterations, 1e6 * balance_seconds, certificate.relative, 1e6 * certificate_seconds));
  out_row.figures.emplace_back(problem.name + "_balance_us", 1e6 * balance_seconds);
  out_row.figures.emplace_back(problem.name + "_certificate_us", 1e6 * certificate_seconds);
  out_row.timed.push_back({.name = "balance point " + problem.name, .ms = 1e3 * balance_seconds});
  out_row.timed.push_back({.name = "certificate " + problem.name, .ms = 1e3 * certificate_seconds});
}

}  // namespace

Row measure_balances(bool quick) {
  Row row;
  if (alternating_scheme(1, 8) == nullptr) row.lines.emplace_back("balance: built without FFTW, no peer");
  row.lines.push_back(fmt::format("{:>14} {:>8} {:>10} {:>6} {:>12} {:>8} {:>10} {:>6} {:>12} {:>8} {:>8}", "balance",
                                  "FFTW: H", "error", "steps", "us", "own: H", "error", "steps", "us", "ratio",
                                  "wanted"));
  const BalanceProblemCase mass = rubbed_mass(), stops = play(), chain = rubbed_chain();
  for (const int harmonics : {9, 21, 49}) add_comparison(mass, harmonics, quick, row);
  for (const int harmonics : {9, 21, 49}) add_comparison(stops, harmonics, quick, row);
  for (const int harmonics : {9, 21}) add_comparison(chain, harmonics, quick, row);
  for (const BalanceProblemCase* problem : {&mass, &stops}) add_point(*problem, quick, row);
  return row;
}

}  // namespace slipmode::bench
