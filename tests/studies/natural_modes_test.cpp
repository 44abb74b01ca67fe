// Modes of a scene with its contacts held.
#include <slipmode/studies/natural_modes.hpp>

#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>

namespace slipmode::studies {
namespace {

using fixtures::belt_chain;
using fixtures::unit;

TEST(StickingModes, HoldFrictionalContactsAndLeaveStopsOpen) {
  const dynamics::HybridSystem belt = belt_chain(friction::Stribeck{0.4, 0.2, 8.0}, friction::Belt::constant(0.2), 4);
  const Eigen::VectorXd alone = sticking_modes(belt, 10).omega;
  ASSERT_EQ(alone.size(), 3);
  std::vector<friction::Contact> contacts = belt.contacts();
  contacts.push_back({unit(4, 1), friction::Clearance{friction::Stop{.stiffness = 10.0, .gap = 0.1}, std::nullopt}});
  const Eigen::VectorXd beside = sticking_modes({belt.structure(), contacts, belt.drive()}, 10).omega;
  EXPECT_EQ(beside, alone);
  // Another law at the place that is held holds nothing more.
  contacts.push_back({belt.contacts()[0].direction, friction::TanhRegularised{}, 1.0});
  EXPECT_EQ(sticking_modes({belt.structure(), contacts, belt.drive()}, 10).omega, alone);
  // Stops alone hold nothing.
  contacts.erase(contacts.begin());
  contacts.pop_back();
  EXPECT_EQ(sticking_modes({belt.structure(), contacts, belt.drive()}, 10).omega.size(), 0);
}

// Four masses, each on a spring to the ground, held to the next by contacts that close a ring: they move as one, at
// √(k/m) (closed form). The fourth contact holds nothing that the others do not.
TEST(StickingModes, OfContactsThatCloseARing) {
  const fem::Structure structure(Eigen::Vector4d::Constant(0.5).asDiagonal().toDenseMatrix(), fem::Rayleigh{},
                                 Eigen::Vector4d::Constant(8.0).asDiagonal().toDenseMatrix());
  std::vector<friction::Contact> contacts;
  for (int i = 0; i < 4; ++i)
    contacts.push_back({unit(4, (i + 1) % 4) - unit(4, i),
                        friction::CompliantCoulomb{.mu_s = 0.3, .mu_k = 0.3, .stiffness = 5.0}, 1.0});
  const fem::Modes held = sticking_modes({structure, contacts, friction::Belt::constant(0.0)}, 10);
  ASSERT_EQ(held.omega.size(), 1);
  EXPECT_NEAR(held.omega(0), 4.0, 1e-14);
  EXPECT_LT((held.shapes.array() - held.shapes(0)).abs().maxCoeff(), 1e-14);
}

TEST(StickShare, IsTheMeanOverContactsWhoseLawSticks) {
  const dynamics::HybridSystem belt = belt_chain(friction::Stribeck{0.4, 0.2, 8.0}, friction::Belt::constant(0.2), 4);
  std::vector<friction::Contact> contacts = belt.contacts();
  contacts.push_back({unit(4, 1), friction::Clearance{friction::Stop{.stiffness = 10.0, .gap = 0.1}, std::nullopt}});
  contacts.push_back({unit(4, 0), friction::CompliantCoulomb{.mu_s = 0.3, .mu_k = 0.3, .stiffness = 5.0}, 1.0});
  const dynamics::HybridSystem system(belt.structure(), contacts, belt.drive());
  EXPECT_DOUBLE_EQ(stick_share(system, std::vector{2.0, 7.0, 6.0}, 8.0), 0.5);
}

}  // namespace
}  // namespace slipmode::studies
