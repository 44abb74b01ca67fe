// Scenes with law = "iwan": what a joint becomes, and what it loses in a cycle beside the closed form.
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/scene/scene.hpp>
#include "fixtures/iwan_reference.hpp"
#include "scene/messages.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace slipmode::scene {
namespace {

using namespace slipmode::tests;

const std::string kJoint = R"(units = "dimensionless"
[structure]
kind = "masses"
mass = [1.0, 0.5]
[[structure.link]]
at = 1
stiffness = 1.0
damping = 0.02
[[structure.link]]
between = [1, 2]
stiffness = 2.0
damping = 0.02

[[contact]]
between = [1, 2]
law = "iwan"
slip_force = 0.4
stiffness = 1.5
chi = -0.5
beta = 0.3
elements = 25

[[contact]]
at = 1
law = "clearance"
stop = { stiffness = 3.0, gap = 50.0 }

[drive]
kind = "force"
omega = 0.6
amplitude = 0.3
at = 2

[time]
duration = 1500.0
sample = 0.5
)";

TEST(JointScene, IsItsElementsAndIsWrittenAsItWasRead) {
  const Scene scene = parse_scene(kJoint);
  ASSERT_EQ(scene.contacts.size(), 27U);  // 25, the impulse, and a stop
  EXPECT_EQ(scene.contacts[0].name, "contact 1, element 1");
  EXPECT_EQ(scene.contacts[26].name, "contact 2");
  double stiffness = 0.0;
  for (const ContactSpec& own : scene.contacts) stiffness += friction::spring_stiffness(own.law);
  EXPECT_NEAR(stiffness, 1.5, 1e-14);
  const std::string text = scene_to_toml(scene);
  EXPECT_EQ(text.find("compliant"), std::string::npos);
  EXPECT_EQ(scene_to_toml(parse_scene(text)), text);
  EXPECT_EQ(get_key(scene, "contact.0.finest"), 0.01);
  const Scene other = set_key(scene, "contact.0.slip_force", 0.8);
  EXPECT_DOUBLE_EQ(other.contacts[3].normal_load.constant, 2.0 * scene.contacts[3].normal_load.constant);
  EXPECT_EQ(get_key(other, "contact.1.stop.gap"), 50.0);
  EXPECT_EQ(get_continuous_key(other, "contact.0.slip_force"), 0.8);
}

TEST(JointScene, WithAnElementChangedIsWrittenElementByElement) {
  Scene scene = parse_scene(kJoint);
  scene.contacts[7].law = friction::CompliantCoulomb{.mu_s = 1.0, .mu_k = 0.5, .stiffness = 0.1};
  const Scene again = parse_scene(scene_to_toml(scene));
  ASSERT_EQ(again.contacts.size(), scene.contacts.size());
  EXPECT_FALSE(again.contacts[7].joint.has_value());
  EXPECT_EQ(friction::limit_coefficient(again.contacts[7].law), 0.5);
  EXPECT_EQ(again.contacts[8].normal_load.constant, scene.contacts[8].normal_load.constant);
}

/// The joint's elements as the scene has them.
std::vector<friction::JenkinsElement> elements_of(const Scene& scene) {
  std::vector<friction::JenkinsElement> elements;
  for (const ContactSpec& own : scene.contacts)
    if (own.joint) elements.push_back({friction::spring_stiffness(own.law), own.normal_load.constant});
  return elements;
}

TEST(JointScene, LosesInACycleWhatItsClosedFormSays) {
  for (const double amplitude : {0.05, 0.1, 0.2}) {
    const Scene scene = set_key(parse_scene(kJoint), "drive.amplitude", amplitude);
    const dynamics::HybridSystem system = build_system(scene);
    const double period = 2.0 * M_PI / 0.6;
    const dynamics::Trajectory settled = dynamics::simulate(system, system.rest(), {.duration = 500.0 * period});
    dynamics::SimulateOptions options{.duration = period};
    options.sample = period / 4096.0;
    const dynamics::Trajectory cycle = dynamics::simulate(system, settled.final_state, options);
    EXPECT_LT((cycle.final_state.q - settled.final_state.q).norm(), 1e-10);  // settled indeed
    const Eigen::VectorXd y = (cycle.q.row(1) - cycle.q.row(0)).transpose();
    const double half = 0.5 * (y.maxCoeff() - y.minCoeff());
    ASSERT_LT(half, friction::largest_slip(scene.contacts.front().joint->law));
    // Samples miss the largest displacement by up to (π / 4096)² / 2 of it.
    const double expected = lost_by_elements(elements_of(scene), half);
    EXPECT_NEAR(cycle.audit.friction_loss, expected, 3e-6 * expected);
    EXPECT_NEAR(expected, lost_by_density(scene.contacts.front().joint->law, half), 0.03 * expected);
    EXPECT_LT(std::abs(cycle.audit.residual()), 1e-9);
  }
}

TEST(JointScene, ElementsThatSlideTurnTogetherAndEveryStepIsCertified) {
  const Scene scene = parse_scene(kJoint);
  const dynamics::HybridSystem system = build_system(scene);
  const dynamics::Trajectory run = dynamics::simulate(system, system.rest(), {.duration = 300.0});
  EXPECT_EQ(run.statistics.certified, run.statistics.steps);
  // Those that slide when their place turns do so at one instant, the others hold: from one turn to the next each
  // element slides at most once.
  std::vector<bool> slides(scene.contacts.size());
  int turns = 0, most = 0;
  for (std::size_t k = 0; k < run.events.size();) {
    int stuck = 0;
    const double time = run.events[k].time;
    for (; k < run.events.size() && run.events[k].time == time; ++k) {
      const dynamics::Event& event = run.events[k];
      slides[static_cast<std::size_t>(event.contact)] = event.kind == dynamics::EventKind::kRelease;
      stuck += event.kind == dynamics::EventKind::kStick ? 1 : 0;
    }
    if (stuck == 0) continue;
    EXPECT_EQ(std::ranges::count(slides, true), 0) << "t = " << time;
    ++turns;
    most = std::max(most, stuck);
  }
  EXPECT_GT(turns, 50);
  EXPECT_GT(most, 5);
}

class JointScenes : public testing::TestWithParam<BadValue> {};

TEST_P(JointScenes, NameWhatIsWrong) { expect_refused(kJoint, GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    All, JointScenes,
    testing::Values(BadValue{"slip_force = 0.4", "slip_force = -1.0", {"s.toml:", "slip_force", "-1", "a number > 0"}},
                    BadValue{"chi = -0.5", "chi = -1.0", {"chi", "a number > -1"}},
                    BadValue{"chi = -0.5\n", "", {"chi", "missing"}},
                    BadValue{"elements = 25", "elements = 0", {"elements", "from 1 to 1000"}},
                    BadValue{"elements = 25", "finest = 0.9", {"finest", "<= 0.5"}},
                    BadValue{"elements = 25", "normal_load = 1.0", {"normal_load", "slip_force"}},
                    BadValue{"elements = 25", "tilt_deg = 1.0", {"tilt_deg"}},
                    BadValue{"law = \"iwan\"", "law = \"iwann\"", {"law", "iwann", "iwan"}}),
    bad_value_name);

}  // namespace
}  // namespace slipmode::scene
