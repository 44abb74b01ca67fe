// Exponents of models and of families, called as a program calls them: without progress, without a journal.

#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/exponent_sweep.hpp>
#include <slipmode/studies/exponents.hpp>

#include <gtest/gtest.h>

namespace slipmode::studies {
namespace {

scene::Scene chain10() { return scene::load_scene(std::string(SLIPMODE_SOURCE_DIR) + "/datasets/chain10/scene.toml"); }

constexpr ExponentRequest kShort = {.exponents = 2, .transient = 50.0, .duration = 100.0, .interval = 1.0};

// Expected: what diagnostics measures on the same model.
TEST(ModelExponents, AreThoseOfTheModelWithoutProgressAsked) {
  const Subjects subjects = subjects_of(chain10(), {});
  const diagnostics::TangentOptions options = tangent_options(chain10(), subjects.full, kShort);
  const auto models = model_exponents(subjects, options);
  ASSERT_EQ(models.size(), 1U);
  EXPECT_EQ(models[0].spectrum.nats, diagnostics::lyapunov_spectrum(subjects.full, subjects.start, options).nats);
}

// Pieces of 0.4 sum up to three units in the last place less than the interval's end at t = 358.4, while the last mass
// sticks: a step over what is left found a release that is none.
TEST(ModelExponents, DoNotStepOverWhatRoundingLeavesOfAnInterval) {
  const scene::Scene scene = scene::parse_scene(R"(
units = "dimensionless"
[structure]
kind = "chain"
masses = 37
stiffness = 30.0
damping = 0.002
mass_damping = 0.01
[[contact]]
at = 19
law = "dahl"
mu = 0.25
stiffness = 5.0
normal_load = 0.6
[[contact]]
at = 37
law = "stribeck"
mu_s = 0.45
mu_k = 0.2
alpha = 4.0
normal_load = 1.0
[drive]
kind = "belt"
speed = 0.13
[time]
duration = 400.0
transient = 150.0
[initial]
at = "static"
)");
  const Subjects subjects = subjects_of(scene, {});
  const auto models = model_exponents(
      subjects, tangent_options(scene, subjects.full, {.exponents = 1, .transient = {}, .duration = {}}));
  EXPECT_EQ(models.at(0).spectrum.failure, "");
}

// Expected: the exponents from the state in which the diagram's own value has settled, without a transient more.
TEST(ExponentSweeps, StandBelowTheirDiagramAndStartWhereItSettled) {
  const Over over{"drive.speed", {0.45, 0.5}};
  const std::vector<SweptModel> models = swept_models(chain10(), over, {});
  const Family& family = models.front().family;
  ExponentSweepOptions options{.tangent = tangent_options(chain10(), family.own(), kShort)};
  const auto sweeps = exponent_sweeps(models, over.values, options, {});
  ASSERT_EQ(sweeps.size(), 1U);
  ASSERT_EQ(sweeps[0].diagram.size(), 2U);
  ASSERT_EQ(sweeps[0].points.size(), 2U);
  options.tangent.transient = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const double speed = sweeps[0].diagram[i].parameter;
    EXPECT_EQ(
        sweeps[0].points[i].settled.nats,
        diagnostics::lyapunov_spectrum(family.at({speed}), sweeps[0].diagram[i].settled.end, options.tangent).nats);
  }
}

}  // namespace
}  // namespace slipmode::studies
