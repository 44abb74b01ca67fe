// Work of a step as forms of its state and forces, beside the same work summed over the pieces of the step.

#include "dynamics/cache.hpp"
#include "dynamics/within_step.hpp"
#include "fixtures/bristle_scenes.hpp"
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>

namespace slipmode::dynamics {
namespace {

using fixtures::Laws;
using fixtures::random_scene;

struct StepOfForces {
  Eigen::VectorXd x, forces;
};

StepOfForces random_step(const ModalModel& model, std::uint64_t seed) {
  fixtures::Random random(seed);
  StepOfForces out{Eigen::VectorXd::Zero(2 * model.np), Eigen::VectorXd::Zero(kNodes * model.contacts)};
  for (Eigen::Index i = 0; i < model.n; ++i) {
    out.x(i) = random.uniform(-1.0, 1.0);
    out.x(model.np + i) = random.uniform(-1.0, 1.0);
  }
  for (double& force : out.forces) force = random.uniform(-1.0, 1.0);
  return out;
}

TEST(WorkForms, OfAStepAreTheSumOverItsPieces) {
  // Just before its end the step is walked in pieces and a Taylor series: other tables, another rule.
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const HybridSystem system = seed % 2 == 0 ? random_scene(seed, Laws::kAll, 12).system
                                              : fixtures::random_bristles(100 + seed, seed % 4 == 1, 10).system;
    const ModelTables tables(build_modal_model(system, false));
    const ModalModel& model = tables.model;
    const StepOfForces step = random_step(model, seed);
    for (const int level : {0, 1, 3, 6}) {
      const double h = tables.steps.step(level);
      const kernels::Work whole = tables.steps.work(level, step.x.data(), step.forces.data());
      WithinStep within(tables.steps, true);
      within.begin(step.x.data(), step.forces.data(), level);
      const kernels::Work pieces = within.work(std::nextafter(h, 0.0));
      const double size = std::abs(whole.contact) + whole.loss + h;
      EXPECT_NEAR(whole.contact, pieces.contact, 1e-12 * size) << "seed " << seed << " level " << level;
      EXPECT_NEAR(whole.loss, pieces.loss, 1e-12 * size) << "seed " << seed << " level " << level << " proportional "
                                                         << model.proportional << " load " << tables.steps.loaded();
    }
  }
}

}  // namespace
}  // namespace slipmode::dynamics
