// The system at values of keys: what is shared and what is built anew must be the same model.

#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/scene/solver_options.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/sweep.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ostream>

namespace slipmode::studies {
namespace {

scene::Scene dataset(const std::string& name) {
  return scene::load_scene(std::string(SLIPMODE_SOURCE_DIR) + "/datasets/" + name + "/scene.toml");
}

/// Displacements of a short run: equal to the last bit for the same model.
Eigen::MatrixXd run_of(const dynamics::HybridSystem& system, const dynamics::State& start) {
  return dynamics::simulate(system, start, {.duration = 20.0, .sample = 0.5}).q;
}

struct Case {
  std::string scene, key;
  double value = 0.0;
};

void PrintTo(const Case& tested, std::ostream* out) {
  *out << tested.scene << ' ' << tested.key << '=' << tested.value;
}

class FamilyOverKey : public testing::TestWithParam<Case> {};

// Expected: the scene with the key written into it, read and built anew.
TEST_P(FamilyOverKey, IsTheSceneWithThatValue) {
  const auto& [name, key, value] = GetParam();
  const scene::Scene scene = dataset(name);
  const Family family(scene, {key});
  const dynamics::HybridSystem anew = scene::build_system(scene::set_key(scene, key, value));
  EXPECT_EQ(run_of(family.at({value}), family.start()), run_of(anew, family.start()));
}

INSTANTIATE_TEST_SUITE_P(
    Keys, FamilyOverKey,
    testing::Values(Case{"chain10", "drive.speed", 0.31}, Case{"chain10", "contact.0.mu_s", 0.45},
                    Case{"chain10", "contact.0.normal_load", 2.5}, Case{"chain10", "structure.stiffness", 1.2},
                    Case{"backlash_sdof", "drive.omega", 0.9}, Case{"backlash_sdof", "drive.amplitude", 0.7},
                    Case{"clearance_3mass", "drive.mean", 0.2}, Case{"clearance_3mass", "drive.direction.0", 0.25},
                    Case{"backlash_sdof", "drive.phase", 0.4},
                    Case{"play_oscillator", "contact.0.left.stiffness", 20.0}),
    [](const auto& tested) {
      std::string name = tested.param.scene + "_" + tested.param.key;
      std::ranges::replace(name, '.', '_');
      return name;
    });

TEST(Family, OfTwoKeysTakesBothInTheirOrder) {
  const scene::Scene scene = dataset("backlash_sdof");
  const Family family(scene, {"drive.omega", "drive.amplitude"});
  const friction::Drive drive = family.at({0.8, 0.6}).drive();
  EXPECT_EQ(drive.force()->omega, 0.8);
  EXPECT_EQ(drive.force()->harmonics.front().amplitude, 0.6);
  EXPECT_EQ(family.axis(1).key, "drive.amplitude");
}

// A number of a law leaves the structure alone: what was built of it is shared, and a mass is not.
TEST(Family, SharesModalDataOverNumbersOfALaw) {
  const scene::Scene scene = dataset("chain10");
  const auto models = [](const dynamics::HybridSystem& system) { return system.cache().models(); };
  const Family law(scene, {"contact.0.mu_s"}), structure(scene, {"structure.stiffness"});
  EXPECT_EQ(models(law.at({0.5})), models(law.own()));
  EXPECT_NE(models(structure.at({1.1})), models(structure.own()));
}

TEST(Family, OfAReducedModelIsTheProjectionOfTheFullOneAtThatValue) {
  const scene::Scene scene = dataset("chain10");
  const dynamics::HybridSystem full = scene::build_system(scene);
  pod::Basis basis = rom::lnm_basis(full.structure(), 4);
  basis.mean = Eigen::VectorXd::LinSpaced(10, 0.1, 1.0);
  const Family family(scene, {"contact.0.mu_s"}, pod::NamedBasis{.name = "four", .basis = basis});
  const scene::Scene other = scene::set_key(scene, "contact.0.mu_s", 0.5);
  const dynamics::HybridSystem anew = rom::reduce(scene::build_system(other), basis);
  EXPECT_EQ(run_of(family.at({0.5}), family.start()), run_of(anew, family.start()));
  EXPECT_EQ(family.title(), "reduced model, 4 modes (four)");
  // ½ q̄ᵀK q̄: a chain of unit springs between walls, stretched by 0.1 each but at the right end (1.0 to the wall).
  EXPECT_NEAR(family.case_at({0.5}).energy_offset, diagnostics::projection_energy(full, basis), 1e-15);
}

TEST(Family, RefusesWhatTheSceneRefusesAndAnotherNumberOfValues) {
  const Family family(dataset("chain10"), {"contact.0.mu_s"});
  EXPECT_THROW((void)family.at({-1.0}), InvalidInput);
  EXPECT_THROW((void)family.at({0.4, 0.5}), InvalidInput);
  EXPECT_THROW((void)family.at({}), InvalidInput);
  EXPECT_THROW((void)Family(dataset("chain10"), {"contact.0.mass"}).at({1.0}), InvalidInput);
}

// In memory, without files. Expected: what the sweep of the chain's own model gives, to the last bit.
TEST(Sweep, InMemoryGoesThroughItsValues) {
  const scene::Scene scene = scene::with_own_times(dataset("chain10"));
  const dynamics::HybridSystem full = scene::build_system(scene);
  const std::vector<double> values = {0.5, 0.45};
  const Sweep found = sweep(Family(scene, {"drive.speed"}), values, {.follow = true});
  const diagnostics::SweepResult expected =
      diagnostics::sweep(diagnostics::belt_model(full), values, scene::initial_state(scene, full),
                         {.mode = SweepMode::kFollow, .settle = scene::sweep_settle_options(scene)});
  ASSERT_EQ(found.belt.size(), 2U);
  EXPECT_TRUE(found.up.empty());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(found.belt[i].parameter, values[i]);
    EXPECT_EQ(found.belt[i].settled.end.q, expected.points[i].settled.end.q);
  }
}

TEST(Sweep, RefusesWhatItsDriveDoesNotHave) {
  EXPECT_THROW((void)sweep(Family(dataset("chain10"), {"drive.speed"}), {0.5}, {.reverse = true}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::studies
