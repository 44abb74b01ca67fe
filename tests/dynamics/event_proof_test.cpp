#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/prepare.hpp>
#include <slipmode/scene/scene.hpp>
#include "dynamics/internal/collocation_flow.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

enum class ProofLaws { kStribeck, kBristles, kMixed, kSprung, kRigid, kTables, kSmooth };

const char* word_of(ProofLaws laws) {
  constexpr std::array kWords = {"Stribeck", "Bristles", "Mixed", "Sprung", "Rigid", "Tables", "Smooth"};
  return kWords[static_cast<std::size_t>(laws)];
}

void PrintTo(ProofLaws laws, std::ostream* out) { *out << word_of(laws); }

/// One contact's law, from flat to steep, from soft to stiff.
std::string random_law(slipmode::Random& r, bool bristle) {
  const double mu_k = r.uniform(0.05, 0.4), mu_s = mu_k + r.uniform(0.0, 0.5);
  const double alpha = r.uniform() < 0.2 ? r.uniform(10.0, 200.0) : r.uniform(0.2, 10.0);
  if (!bristle)
    return fmt::format("law = \"stribeck\"\nmu_s = {}\nmu_k = {}\nnormal_load = 1.0\nalpha = {}\n", mu_s, mu_k, alpha);
  const double stiffness = std::pow(10.0, r.uniform(0.0, 4.0));
  if (r.uniform() < 0.3)
    return fmt::format("law = \"dahl\"\nmu = {}\nnormal_load = 1.0\nstiffness = {}\n", mu_s, stiffness);
  return fmt::format(
      "law = \"lugre\"\nmu_s = {}\nmu_k = {}\nnormal_load = 1.0\nstiffness = {}\ndamping = {}\nviscous = "
      "{}\nstribeck_speed = {}\n",
      mu_s, mu_k, stiffness, r.uniform() < 0.3 ? 0.0 : r.uniform(0.0, 1.0) * std::sqrt(stiffness), r.uniform(0.0, 0.1),
      1.0 / alpha);
}

/// Points close together and far apart, rising and falling, from nothing too.
std::string random_table(slipmode::Random& r) {
  std::string speeds = "0.0";
  const double first = r.uniform() < 0.2 ? 0.0 : r.uniform(0.05, 0.5);
  std::string coefficients = fmt::format("{}", first);
  double speed = 0.0;
  for (int further = 1 + static_cast<int>(r.uniform() * 5); further > 0; --further) {
    speed += std::pow(10.0, r.uniform(-2.0, 0.0));
    speeds += fmt::format(", {}", speed);
    coefficients += fmt::format(", {}", r.uniform(0.0, 0.5));
  }
  return fmt::format("law = \"table\"\nmu_s = {}\nspeeds = [{}]\ncoefficients = [{}]\nnormal_load = 1.0\n",
                     r.uniform() < 0.4 ? first : first + r.uniform(0.0, 0.3), speeds, coefficients);
}

std::string random_smooth(slipmode::Random& r) {
  const double mu_k = r.uniform(0.05, 0.4);
  return fmt::format("law = \"tanh\"\nmu_s = {}\nmu_k = {}\nalpha = {}\nepsilon = {}\nnormal_load = 1.0\n",
                     mu_k + r.uniform(0.0, 0.5), mu_k, r.uniform(0.2, 10.0), std::pow(10.0, r.uniform(-2.0, 0.0)));
}

/// A spring that slides, its load constant or not, or stops with and without damping.
std::string random_spring(slipmode::Random& r) {
  const double stiffness = std::pow(10.0, r.uniform(-0.5, 2.0)), mu_k = r.uniform(0.05, 0.4),
               mu_s = r.uniform() < 0.5 ? mu_k : mu_k + r.uniform(0.0, 0.5), slope = r.uniform(-1.0, 1.0),
               damping = r.uniform(0.0, 0.3), gap = r.uniform(0.05, 0.6);
  const double kind = r.uniform();
  if (kind < 0.5)
    return fmt::format("law = \"compliant\"\nmu_s = {}\nmu_k = {}\nstiffness = {}\nnormal_load = {}\n", mu_s, mu_k,
                       stiffness, kind < 0.1 ? fmt::format("{{ constant = 1.0, slope = {} }}", slope) : "1.0");
  return fmt::format("law = \"clearance\"\nloss = \"{}\"\nright = {{ stiffness = {}, damping = {}, gap = {} }}\n",
                     kind < 0.75 ? "gap" : "zero-force", stiffness, kind < 0.6 ? 0.0 : damping, gap);
}

/// Coulomb friction between two masses, its load constant or not, so that one contact's force accelerates the other.
std::string random_rigid(slipmode::Random& r, int n) {
  const double mu_k = r.uniform(0.05, 0.6), mu_s = r.uniform() < 0.5 ? mu_k : mu_k + r.uniform(0.0, 0.5),
               slope = r.uniform() < 0.7 ? r.uniform(-1.0, 1.0) : 0.0;
  return fmt::format(
      "between = [{}, {}]\nlaw = \"coulomb\"\nmu_s = {}\nmu_k = {}\nnormal_load = {{ constant = {}, slope = {} }}\n",
      n - 1, n, mu_s, mu_k, r.uniform(0.5, 5.0), slope);
}

/// From here on random chains are driven by a force.
constexpr std::uint64_t kForced = 60;

/// A chain with one or two contacts: any damping, belts, ramps and shakers, and forces.
std::string random_chain(std::uint64_t index, int contacts, ProofLaws laws) {
  slipmode::Random r = slipmode::Random::stream(77, index);
  const int n = contacts + static_cast<int>(r.uniform() * 8);
  std::string text = fmt::format(
      "units = \"dimensionless\"\n[structure]\nkind = \"chain\"\nmasses = {}\nmass = 1.0\nstiffness = 1.0\n"
      "damping = {}\n",
      n, r.uniform() < 0.2 ? 0.0 : r.uniform(0.0, 0.05));
  for (int c = 0; c < contacts; ++c) {
    const bool bristle = laws == ProofLaws::kBristles || (laws == ProofLaws::kMixed && c == 1);
    const bool sprung = laws == ProofLaws::kSprung && c == 1;
    if (laws == ProofLaws::kRigid && c == 1)
      text += "[[contact]]\n" + random_rigid(r, n);
    else if (laws == ProofLaws::kTables || (laws == ProofLaws::kSmooth && c == 1))
      text += fmt::format("[[contact]]\nat = {}\n{}", n - c,
                          laws == ProofLaws::kTables ? random_table(r) : random_smooth(r));
    else
      text += fmt::format("[[contact]]\nat = {}\n{}", n - c, sprung ? random_spring(r) : random_law(r, bristle));
  }
  const double kind = r.uniform(), from = r.uniform(-0.6, 0.6), to = r.uniform(-0.6, 0.6);
  if (index >= kForced)
    text += fmt::format("[drive]\nkind = \"force\"\nomega = {}\namplitude = {}\nat = {}\n", r.uniform(0.1, 3.0),
                        r.uniform(0.1, 2.0), 1 + static_cast<int>(r.uniform() * n));
  else if (kind < 0.5)
    text += fmt::format("[drive]\nkind = \"belt\"\nspeed = {}\n", kind < 0.1 ? 0.0 : from);
  else if (kind < 0.7)
    text +=
        fmt::format("[drive]\nkind = \"belt\"\nspeed = {{ from = {}, to = {}, begin = 3.0, end = 12.0 }}\n", from, to);
  else
    text += fmt::format("[drive]\nkind = \"shaker\"\nfrequency = {}\namplitude = {}\n", r.uniform(0.05, 0.4),
                        r.uniform(0.1, 1.0));
  text += "[time]\nduration = 40.0\nsample = 1.0\n[initial]\n";
  for (const char* key : {"displacement", "velocity"}) {
    text += fmt::format("{} = [", key);
    for (int i = 0; i < n; ++i) text += fmt::format("{}, ", r.uniform(-1.0, 1.0));
    text += "]\n";
  }
  return text;
}

struct Judged {
  int steps = 0, certified = 0, judged = 0, wrong = 0;
};

/// Every step of a run beside the motion from the step's own start at tolerance 1e-13: does that pass an event where
/// the step has none?
Judged judge_steps(std::uint64_t index, int contacts, ProofLaws laws, double tolerance) {
  constexpr double kDuration = 40.0;
  const scene::Scene scene = scene::parse_scene(random_chain(index, contacts, laws));
  const HybridSystem system = scene::build_system(scene);
  const Prepared p =
      prepare(system, scene::initial_state(scene, system), {.tolerance = tolerance, .certify = true}, false);
  FlowOptions fine = p.options;
  fine.tolerance = 1e-13;
  fine.certify = false;
  CollocationFlow flow(system, p.tables.steps, p.start, p.options);
  const EventResolver resolver(system, p.tables.model, fine);
  Judged out;
  while (flow.point().time < kDuration) {
    HybridPoint begin = flow.point();
    const auto before = flow.statistics();
    flow.step(kDuration);
    const double end = flow.point().time;
    out.steps += static_cast<int>(flow.statistics().steps - before.steps);
    if (flow.statistics().certified == before.certified) continue;
    ++out.certified;
    try {
      resolver.hold(begin.time, begin.modes, begin.x.data());
      CollocationFlow reference(system, p.tables.steps, begin, fine);
      while (reference.point().time < end && reference.events().empty()) reference.step(end);
      ++out.judged;
      if (reference.events().empty()) continue;
      const Event& event = reference.events().front();
      // The step's own event, by time or where it is shallow by the guard; or the one it began with, seen again: a
      // release at its limit but for the tolerance, a load of rounding of either sign.
      const bool same = event.contact >= 0 && !flow.events().empty() && flow.events().front().contact == event.contact;
      const auto speed_at = [&](double t) {  // of the computed motion
        Eigen::VectorXd x, force(contacts);
        flow.evaluate(t, x, force);
        return system.drive().velocity(t) - resolver.contact_velocity(event.contact, x.data());
      };
      const bool own =
          same && (end - event.time < 10.0 * tolerance ||
                   (event.before != ContactMode::kStick && std::abs(speed_at(event.time)) < 10.0 * tolerance));
      const auto c = static_cast<std::size_t>(event.contact);
      // A root is known to rounding of the step it is sought in, not of the step's start.
      const bool begun = event.contact >= 0 && event.after == begin.modes[c] &&
                         (event.time - begin.time <= 4.0 * std::numeric_limits<double>::epsilon() * end ||
                          (begin.multiplicity[c] > 0 && event.time - begin.time < tolerance));
      if (!own && !begun && end - event.time > 1e-13 * end) ++out.wrong;
    } catch (const NumericalFailure&) {  // stuck contacts whose speed the step's start holds to its tolerance only
    }
  }
  return out;
}

class CertifiedSteps : public testing::TestWithParam<std::tuple<int, ProofLaws, double>> {};

TEST_P(CertifiedSteps, PassNoEventAtAnyTolerance) {
  const auto [contacts, laws, tolerance] = GetParam();
  Judged all;
  for (std::uint64_t index = 0; index < kForced + 30; ++index) {
    const Judged one = judge_steps(index, contacts, laws, tolerance);
    all.steps += one.steps;
    all.certified += one.certified;
    all.judged += one.judged;
    all.wrong += one.wrong;
  }
  EXPECT_EQ(all.wrong, 0) << "of " << all.judged;
  EXPECT_GT(all.judged, 9 * all.certified / 10);
  // What stays open: grazings, starts at two limits at once, bristles at rest; and what a loose tolerance does not
  // resolve, the way of a bristle near a reversal, a smooth law's through zero.
  const double share = laws == ProofLaws::kStribeck ? (contacts == 1 ? 0.99 : 0.9)
                       : tolerance > 1e-5           ? 0.3
                       : laws == ProofLaws::kSmooth ? 0.85
                                                    : 0.9;
  EXPECT_GT(all.certified, share * all.steps) << all.steps;
}

std::string name_of(const testing::TestParamInfo<std::tuple<int, ProofLaws, double>>& cell) {
  const auto [contacts, laws, tolerance] = cell.param;
  return fmt::format("Contacts{}{}Tolerance1em{:.0f}", contacts, word_of(laws), -std::log10(tolerance));
}

INSTANTIATE_TEST_SUITE_P(Single, CertifiedSteps,
                         testing::Combine(testing::Values(1),
                                          testing::Values(ProofLaws::kStribeck, ProofLaws::kBristles),
                                          testing::Values(1e-1, 1e-3, 1e-6, 1e-9)),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Coupled, CertifiedSteps,
                         testing::Combine(testing::Values(2),
                                          testing::Values(ProofLaws::kStribeck, ProofLaws::kBristles, ProofLaws::kMixed,
                                                          ProofLaws::kSprung),
                                          testing::Values(1e-1, 1e-3, 1e-6, 1e-9)),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Bounded, CertifiedSteps,
                         testing::Combine(testing::Values(1, 2), testing::Values(ProofLaws::kTables),
                                          testing::Values(1e-1, 1e-3, 1e-6, 1e-9)),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Beside, CertifiedSteps,
                         testing::Combine(testing::Values(2), testing::Values(ProofLaws::kSmooth),
                                          testing::Values(1e-1, 1e-3, 1e-6, 1e-9)),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Rigid, CertifiedSteps,
                         testing::Combine(testing::Values(2), testing::Values(ProofLaws::kRigid),
                                          testing::Values(1e-3, 1e-6, 1e-9)),
                         name_of);

TEST(EventProof, BoundsWhatTheInterpolantOfASpeedLeavesOut) {
  // Exact motion under polynomial forces at 65 times, beside the polynomial of degree 8 through nodes and start.
  slipmode::Random random = slipmode::Random::stream(5, 0);
  double tightest = 0.0;
  for (std::uint64_t index = 0; index < 12; ++index) {
    const scene::Scene scene =
        scene::parse_scene(random_chain(index, 1 + static_cast<int>(index % 2), ProofLaws::kStribeck));
    const HybridSystem system = scene::build_system(scene);
    const Prepared p = prepare(system, scene::initial_state(scene, system), {}, false);
    const StepTables& tables = p.tables.steps;
    const ModalModel& model = p.tables.model;
    const RadauTables& nodes = radau();
    for (int level = 0; level < 4; ++level) {
      Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * model.np), forces(kNodes * model.contacts), v(forces.size());
      for (Eigen::Index i = 0; i < model.n; ++i) {
        x(i) = random.normal();
        x(model.np + i) = random.normal();
      }
      for (double& force : forces) force = index < 6 ? random.normal() : 0.0;
      tables.collocation(level).velocities(x.data(), forces.data(), v.data());
      const StepBounds& bounds = tables.bounds(level);
      WithinStep within(tables, false);
      within.begin(x.data(), forces.data(), level);
      for (int c = 0; c < model.contacts; ++c) {
        double ninth = bounds.ninth_by_load(c) + bounds.ninth_by_state.col(c).dot(x.cwiseAbs());
        for (int d = 0; d < model.contacts; ++d)
          ninth += bounds.ninth_by_force.col(c)
                       .segment<kNodes>(kNodes * d)
                       .dot((nodes.legendre * forces.segment<kNodes>(kNodes * d)).cwiseAbs());
        const RadauTables::Vector8 by_nodes =
            nodes.chebyshev * v.segment<kNodes>(kNodes * c) + nodes.chebyshev_start * model.velocity_row.col(c).dot(x);
        const double mean = nodes.chebyshev_mean.dot(v.segment<kNodes>(kNodes * c)) +
                            nodes.chebyshev_mean_start * model.velocity_row.col(c).dot(x);
        double largest = 0.0;
        Eigen::VectorXd now(2 * model.np);
        for (int k = 0; k <= 64; ++k) {
          const double share = k / 64.0;
          within.state(share * tables.step(level), now.data());
          double p8 = mean;
          for (int j = 1; j <= kNodes; ++j) p8 += by_nodes(j - 1) * std::cos(j * std::acos(2.0 * share - 1.0));
          largest = std::max(largest, std::abs(model.velocity_row.col(c).dot(now) - p8));
        }
        EXPECT_LE(largest, nodes.remainder[0] * ninth) << "scene " << index << " level " << level;
        tightest = std::max(tightest, largest / (nodes.remainder[0] * ninth));
      }
    }
  }
  EXPECT_GT(tightest, 0.1) << "a bound ten times too large in every case would prove little";
}

TEST(EventProof, RemaindersAreThoseOfTheNinthPower) {
  // t⁹ less its interpolant of degree 8 is Ω itself, whose ninth derivative is 9!: Shadrin's bounds are attained.
  const RadauTables& nodes = radau();
  double largest = 0.0;
  for (int k = 0; k <= 5000; ++k) {
    const double t = k / 5000.0;
    largest = std::max(largest, std::abs(t * (t - nodes.node.array()).prod()));
  }
  EXPECT_NEAR(nodes.remainder[0] * 362880.0, largest, 2e-3 * largest);
  EXPECT_GT(nodes.remainder[1], 9.0 * nodes.remainder[0]);
  EXPECT_GE(nodes.lebesgue, nodes.lagrange(0.0).cwiseAbs().sum());
}

}  // namespace
}  // namespace slipmode::dynamics
