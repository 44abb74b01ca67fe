// What a scene does does not depend on the units it is told in: nothing is measured by a metre, a second or a kilogram.
#include "fixtures/other_units.hpp"
#include <slipmode/core/errors.hpp>
#include <slipmode/scene/scene.hpp>
#include "selftest/random_scene.hpp"

#include <gtest/gtest.h>
#include <algorithm>

namespace slipmode::selftest {
namespace {

using fixtures::OtherUnits;

/// The largest distance between a run and the same one in other units, of the motion's sizes; a thousand samples.
double apart(const std::string& text, const OtherUnits& units) {
  const scene::Scene scene = scene::parse_scene(text);
  const dynamics::HybridSystem system = scene::build_system(scene), other = units.tell(system);
  const dynamics::State start = scene::initial_state(scene, system);
  dynamics::SimulateOptions options = scene::simulate_options(scene), in_other = options;
  options.sample = options.duration / 1000.0;
  options.transient = in_other.transient = 0.0;
  in_other.duration *= units.of("s");
  in_other.sample = options.sample * units.of("s");
  const dynamics::Trajectory a = dynamics::simulate(system, start, options),
                             b = dynamics::simulate(other, units.tell(system, start), in_other);
  const Eigen::Index samples = std::min(a.times.size(), b.times.size());
  EXPECT_GE(samples, 1000);
  const auto distance = [&](const Eigen::MatrixXd& x, const Eigen::MatrixXd& y, double by) {
    return (x.leftCols(samples) - y.leftCols(samples) / by).cwiseAbs().maxCoeff() /
           std::max(x.cwiseAbs().maxCoeff(), 1e-200);
  };
  return std::max(distance(a.q, b.q, units.of("m")), distance(a.v, b.v, units.of("m/s")));
}

void expect_the_same(const OtherUnits& units) {
  for (std::uint64_t index = 0; index < 100; ++index)
    EXPECT_LT(apart(random_scene_text(301, index), units), 1e-7) << "scene " << index;
}

TEST(OtherUnits, OfSlowLightThingsMakeTheSameMotions) {
  // Speeds of 1e-12: Newton's method took changes of 1e-14 m/s for rounding, and left 1e-5 of the motion.
  expect_the_same({.mass = 20, .length = -20, .time = 20});
}

TEST(OtherUnits, OfFastLightThingsMakeTheSameMotions) {
  // Masses of 1e-12 at 1e5 rad/s, as in micromechanics: one scene in 60 was refused, as the displacement of a normal
  // oscillator, in metres, stood beside coordinates in m sqrt(kg).
  expect_the_same({.mass = -40, .length = 30, .time = -16});
}

TEST(OtherUnits, AreUnderstoodByEveryStart) {
  // A contact that slides backwards at 1e-12 m/s does not slide forwards, however small that is beside 1 m/s.
  const auto one = [](double value) { return fem::Matrix(Eigen::MatrixXd::Constant(1, 1, value)); };
  const dynamics::HybridSystem system(fem::Structure(one(1.0), one(0.0), one(1.0)),
                                      {{Eigen::VectorXd::Ones(1), friction::Coulomb{0.4, 0.2}, 1.0}},
                                      friction::Belt::constant(0.1));
  dynamics::State start = system.rest();
  start.v(0) = 0.3;
  start.modes = {dynamics::ContactMode::kSlipPositive};
  for (const int length : {0, -20, -40}) {
    const OtherUnits units{.length = length};
    EXPECT_THROW(static_cast<void>(simulate(units.tell(system), units.tell(system, start), {.duration = 1.0})),
                 InvalidInput)
        << length;
  }
}

}  // namespace
}  // namespace slipmode::selftest
