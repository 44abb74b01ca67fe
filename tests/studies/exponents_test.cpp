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

// Expected: the exponents from the state in which the diagram's own value has settled, without a transient more.
TEST(ExponentSweeps, StandBelowTheirDiagramAndStartWhereItSettled) {
  const Family family(chain10(), {"drive.speed"});
  ExponentSweepOptions options{.tangent = tangent_options(chain10(), family.own(), kShort)};
  const auto sweeps = exponent_sweeps({family}, {0.45, 0.5}, options, {});
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
