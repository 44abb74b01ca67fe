// Work of a step by its nodes and by forms of its state and forces, beside the same work summed over its pieces.

#include <slipmode/dynamics/cache.hpp>
#include "dynamics/internal/within_step.hpp"
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

/// @param last  size of the forces' part of degree 7, to which the parts of lower degree fall steadily
StepOfForces random_step(const ModalModel& model, std::uint64_t seed, double last) {
  fixtures::Draws random(seed);
  StepOfForces out{Eigen::VectorXd::Zero(2 * model.np), Eigen::VectorXd::Zero(kNodes * model.contacts)};
  for (Eigen::Index i = 0; i < model.n; ++i) {
    out.x(i) = random.uniform(-1.0, 1.0);
    out.x(model.np + i) = random.uniform(-1.0, 1.0);
  }
  for (int c = 0; c < model.contacts; ++c)
    for (int k = 0; k < kNodes; ++k) {
      const double size = std::pow(last, k / 7.0) * random.uniform(-1.0, 1.0);
      for (int j = 0; j < kNodes; ++j)
        out.forces(kNodes * c + j) += size * std::legendre(static_cast<unsigned>(k), 2.0 * radau().node(j) - 1.0);
    }
  return out;
}

TEST(ProductRule, IsExactForForcesOfDegree7TimesVelocitiesOfDegree8) {
  const RadauTables& t = radau();
  for (const kernels::Kernels* set : kernels::available())
    for (int k = 0; k < kNodes; ++k)
      for (int l = 0; l <= kNodes; ++l) {
        const RadauTables::Vector8 a = t.node.array().pow(k), b = t.node.array().pow(l);
        EXPECT_NEAR(set->product_integral(t.product, a.data(), b.data(), l == 0 ? 1.0 : 0.0), 1.0 / (k + l + 1), 1e-14)
            << "t^" << k << " t^" << l;
      }
}

TEST(StepWork, IsTheSumOverThePiecesOfTheStep) {
  // Just before its end the step is walked in pieces and a Taylor series: other tables, another rule. Forces fall as
  // in steps at the loosest tolerance, and at a usual one. What the nodes' rule leaves of the contacts' work begins
  // with the force of degree 6 times the velocity of degree 9, which over 4 rad has a coefficient 19 j₉(2) = 1.5e-5;
  // what six points leave of the loss, with squares of velocities of degree 6, which forces of degree 5 cause.
  for (const double last : {1e-4, 1e-7})
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      const HybridSystem system = seed % 2 == 0 ? random_scene(seed, Laws::kAll, 12).system
                                                : fixtures::random_bristles(100 + seed, seed % 4 == 1, 10).system;
      const ModelTables tables(build_modal_model(system, false));
      const ModalModel& model = tables.model;
      const StepOfForces step = random_step(model, seed, last);
      for (const int level : {0, 1, 3, 6}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", level " << level << ", part of degree 7 " << last
                                        << ", proportional " << model.proportional);
        const double h = tables.steps.step(level);
        Eigen::VectorXd velocities(kNodes * model.contacts);
        tables.steps.collocation(level).velocities(step.x.data(), step.forces.data(), velocities.data());
        const kernels::Work whole = tables.steps.work(level, step.x.data(), step.forces.data(), velocities.data());
        WithinStep within(tables.steps, true);
        within.begin(step.x.data(), step.forces.data(), level);
        const kernels::Work pieces = within.work(std::nextafter(h, 0.0));
        const double size = std::abs(whole.contact) + whole.loss + h;
        EXPECT_NEAR(whole.contact, pieces.contact, 1.5e-5 * std::pow(last, 6.0 / 7.0) * size);
        EXPECT_NEAR(whole.loss, pieces.loss, std::max(1e-12, 1e-4 * std::pow(last, 10.0 / 7.0)) * size);
      }
    }
}

}  // namespace
}  // namespace slipmode::dynamics
