// The joint of an Iwan law as Jenkins elements, beside the closed forms of its density.
#include <slipmode/friction/iwan.hpp>
#include "fixtures/iwan_reference.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <vector>

namespace slipmode::friction {
namespace {

const std::vector<Iwan> kJoints = {{.slip_force = 1.0, .stiffness = 1.0, .chi = 0.0, .beta = 0.0},
                                   {.slip_force = 4000.0, .stiffness = 1.5e7, .chi = -0.82, .beta = 1.16},
                                   {.slip_force = 0.3, .stiffness = 20.0, .chi = -0.3, .beta = 0.005},
                                   {.slip_force = 2.0, .stiffness = 5.0, .chi = 0.7, .beta = 3.0}};

Iwan divided(Iwan joint, int elements, double finest) {
  joint.elements = elements;
  joint.finest = finest;
  return joint;
}

/// Over amplitudes from this share of φ_max on.
double worst_error(const Iwan& joint, double from) {
  const std::vector<JenkinsElement> elements = elements_of(joint);
  double worst = 0.0;
  for (double share = from; share <= 1.0; share *= 1.003) {
    const double u = share * largest_slip(joint);
    worst = std::max(worst, std::abs(tests::lost_by_elements(elements, u) / tests::lost_by_density(joint, u) - 1.0));
  }
  return worst;
}

TEST(Iwan, ElementsHaveTheStiffnessAndTheSlipForceOfTheJoint) {
  for (const Iwan& joint : kJoints) {
    for (const int elements : {1, 2, 7, 100}) {
      double stiffness = 0.0, force = 0.0;
      const std::vector<JenkinsElement> parts = elements_of(divided(joint, elements, 0.001));
      EXPECT_EQ(parts.size(), static_cast<std::size_t>(elements + (joint.beta > 0.0 ? 1 : 0)));
      for (const JenkinsElement& own : parts) {
        EXPECT_GT(own.stiffness, 0.0);
        stiffness += own.stiffness;
        force += own.slip_force;
      }
      EXPECT_NEAR(stiffness, joint.stiffness, 1e-13 * joint.stiffness);
      EXPECT_NEAR(force, joint.slip_force, 1e-13 * joint.slip_force);
      EXPECT_TRUE(std::ranges::is_sorted(parts, {}, [](const auto& own) { return own.slip_force / own.stiffness; }));
      EXPECT_LE(parts.back().slip_force / parts.back().stiffness, largest_slip(joint) * (1.0 + 1e-13));
    }
  }
}

TEST(Iwan, LosesTheEnergyOfItsDensityToSecondOrder) {
  for (const Iwan& joint : kJoints) {
    // The same range of slips with twice the intervals: their ratio's logarithm halves.
    const double coarse = worst_error(divided(joint, 41, 0.001), 0.1),
                 fine = worst_error(divided(joint, 81, 0.001), 0.1);
    EXPECT_GT(coarse / fine, 3.4);
    EXPECT_LT(coarse / fine, 4.6);
    EXPECT_LT(worst_error(joint, 0.1), 0.03);  // as docs/theory/compliant-contacts.md says of the default
  }
}

}  // namespace
}  // namespace slipmode::friction
