// Starts on guards, grazing, simultaneous events, Zeno, long runs, random scenes.
#include "selftest/cases.hpp"
#include "selftest/scene_properties.hpp"
#include "selftest/small_systems.hpp"

#include <algorithm>
#include <numbers>

namespace slipmode::selftest {
namespace {

using dynamics::EventKind;
using dynamics::FlowMethod;
using friction::Belt;
using friction::Coulomb;
using friction::Stribeck;

/// On both guards at once: at the belt's speed with the stick force at its limit. Released at once.
double start_at_release() {
  const auto run =
      dynamics::simulate(one_mass(Coulomb{0.4, 0.2}, Belt::constant(0.1)), state_of(0.4, 0.1), {.duration = 1.0});
  if (run.events.empty()) return std::abs(run.final_state.v(0) - 0.1) < 1e-3 ? 1.0 : 0.0;
  return run.events.front().kind == EventKind::kRelease ? run.events.front().time : 1.0;
}

/// A slip whose speed comes up to the belt's and no further: 0.5 sin t about μ N/k against V = 0.5 (1 + gap).
double grazing(double gap) {
  const double V = 0.5 * (1.0 + gap), mu = 0.3;
  const auto run = dynamics::simulate(one_mass(Coulomb{mu, mu}, Belt::constant(V)), state_of(mu, 0.5),
                                      {.duration = 40.0, .sample = 0.1});
  double worst = 0.0;
  for (Eigen::Index k = 0; k < run.times.size(); ++k)
    worst = std::max(worst, std::abs(run.q(0, k) - mu - 0.5 * std::sin(run.times(k))));
  return worst;
}

/// Two contacts placed as mirror images: their events come in pairs at one time, and the motion stays symmetric.
double simultaneous(FlowMethod method) {
  const dynamics::HybridSystem system(
      fem::chain({.masses = 5, .damping = 0.01, .right_fixed = true}),
      {{Eigen::VectorXd::Unit(5, 1), Coulomb{0.4, 0.2}, 1.0}, {Eigen::VectorXd::Unit(5, 3), Coulomb{0.4, 0.2}, 1.0}},
      Belt::constant(0.15));
  const auto run =
      dynamics::simulate(system, system.rest(), {.duration = 60.0, .sample = 0.1, .flow = {.method = method}});
  if (run.events.size() < 8 || run.events.size() % 2 != 0) return 1.0;
  double worst = (run.q - run.q.colwise().reverse()).cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < run.events.size(); i += 2)
    worst = std::max(worst, run.events[i + 1].time - run.events[i].time);
  return worst;
}

double zeno() {
  const auto chain = uniform_chain(10, Coulomb{0.4, 0.2}, 0.2);
  const dynamics::State start{0.0, Eigen::VectorXd::LinSpaced(10, -1.0, 1.5),
                              Eigen::VectorXd::LinSpaced(10, 1.0, -1.0)};
  return refused<NumericalFailure>([&] {
    static_cast<void>(dynamics::simulate(
        chain, start, {.duration = 200.0, .flow = {.max_events_per_window = 3, .zeno_window = 200.0}}));
  });
}

/// Stuck behind a spring of 3, q'' + 4q = 0.3 sin ωt with ω at 2 or next to it, beside its closed form: by
/// sin ωt − (ω/2) sin 2t = 2 cos((ω+2)t/2) sin((ω−2)t/2) − ((ω−2)/2) sin 2t there is nothing to divide by.
double resonance(double detuning) {
  const double omega = 2.0 + detuning;
  const dynamics::HybridSystem system =
      one_mass(friction::CompliantCoulomb{1e3, 1e3, 3.0},
               friction::Shaker{.amplitude = 0.1, .frequency_hz = omega / (2.0 * std::numbers::pi)});
  const auto run = dynamics::simulate(system, system.rest(), {.duration = 200.0, .sample = 0.1});
  double worst = 0.0, largest = 0.0;
  for (Eigen::Index k = 0; k < run.times.size(); ++k) {
    const double t = run.times(k), phase = detuning * t / 2.0;
    const double beat = phase == 0.0 ? t / 2.0 : std::sin(phase) / detuning;
    const double q =
        0.3 / (4.0 + detuning) * (std::sin(2.0 * t) / 2.0 - 2.0 * std::cos((2.0 + detuning / 2.0) * t) * beat);
    worst = std::max(worst, std::abs(run.q(0, k) - q));
    largest = std::max(largest, std::abs(q));
  }
  return std::max(worst / largest, std::abs(run.audit.residual()));
}

double audit(const friction::Law& law, double duration) {
  const auto chain = uniform_chain(10, law, 0.2);
  return std::abs(
      dynamics::simulate(chain, chain.rest(), {.duration = duration, .keep_events = false}).audit.residual());
}

/// Drift of a periodic cycle's time of release after a thousand and more periods, relative to the time.
double late_events(double duration) {
  const Coulomb law{0.4, 0.2};
  const double V = 0.1, drop = 0.2, period = std::numbers::pi + 2.0 * std::atan2(V, drop) + 2.0 * drop / V;
  double last = 0.0, count = 0.0;
  static_cast<void>(dynamics::simulate(one_mass(law, Belt::constant(V)), state_of(0.4, V),
                                       {.duration = duration,
                                        .keep_events = false,
                                        .flow = {.audit = false},
                                        .on_event = [&](const dynamics::Event& e, const dynamics::State&) {
                                          if (e.kind != EventKind::kRelease || e.time < 1.0) return true;
                                          last = e.time;
                                          count += 1.0;
                                          return true;
                                        }}));
  return std::abs(last - count * period) / last;
}

double survey(std::uint64_t count) {
  return static_cast<double>(survey_random_scenes(1, 0, count, {.threads = 1}).failed.size());
}

double thread_bytes() {
  double different = 0.0;
  for (std::uint64_t index = 0; index < 40; ++index) different += same_bytes_on_threads(1, index, 2) ? 0.0 : 1.0;
  return different;
}

}  // namespace

std::vector<ExtremeCase> event_cases() {
  return {
      {"start on two guards", "time until the release", 1e-12, start_at_release},
      {"grazing, exact", "motion beside the harmonic one", 1e-7, [] { return grazing(0.0); }},
      {"grazing, gap 1e-12", "motion beside the harmonic one", 1e-7, [] { return grazing(1e-12); }},
      {"grazing, gap -1e-12", "motion beside the harmonic one", 1e-5, [] { return grazing(-1e-12); }},
      {"simultaneous events, closed form", "distance of pairs and from symmetry", 1e-10,
       [] { return simultaneous(FlowMethod::kClosedForm); }},
      {"simultaneous events, collocation", "distance of pairs and from symmetry", 1e-9,
       [] { return simultaneous(FlowMethod::kCollocation); }},
      {"Zeno", "a clear failure", 0.0, zeno},
      {"undamped resonance", "motion beside its closed form, relative, and energy audit", 1e-12,
       [] {
         return std::max({resonance(0.0), resonance(1e-15), resonance(-1e-9), resonance(1e-4), resonance(-0.01)});
       }},
      {"1e7 units, ten masses, Coulomb", "energy audit", 1e-9,
       [] {
         return audit(Coulomb{0.4, 0.2}, 1e7);
       }},
      {"1e7 units, ten masses, Stribeck", "energy audit", 1e-9,
       [] {
         return audit(Stribeck{0.4, 0.2, 8.0}, 1e7);
       },
       true},
      {"1e7 units, one mass", "time of the last release beside count times period, relative", 1e-9,
       [] { return late_events(1e7); }},
      {"same bytes", "random scenes that differ on 1 and 2 threads, of 40", 0.0, thread_bytes},
      {"300 random scenes", "scenes with a violation", 0.0, [] { return survey(300); }},
      {"10,000 random scenes", "scenes with a violation", 0.0, [] { return survey(10000); }, true},
  };
}

}  // namespace slipmode::selftest
