#include <slipmode/diagnostics/attractors/sweep.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/rom/reduce.hpp>
#include "models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <utility>

namespace slipmode::diagnostics {
namespace {

const std::vector<double> kSpeeds = {0.45, 0.40, 0.35, 0.30, 0.25, 0.20};

SettleOptions quick() { return {.transient = 200.0, .block = 800.0, .limit = 1600.0, .energy_samples = 64}; }

bool same_bytes(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

/// Every number of two finished points, bit for bit.
void expect_same(const SweepPoint& a, const SweepPoint& b) {
  EXPECT_EQ(a.index, b.index);
  EXPECT_EQ(a.model, b.model);
  EXPECT_EQ(a.parameter, b.parameter);
  EXPECT_EQ(a.failure, b.failure);
  EXPECT_TRUE(same_bytes(a.settled.end.q, b.settled.end.q));
  EXPECT_TRUE(same_bytes(a.settled.end.v, b.settled.end.v));
  EXPECT_EQ(a.settled.period.motion, b.settled.period.motion);
  EXPECT_EQ(a.settled.period.T, b.settled.period.T);
  EXPECT_EQ(a.settled.mean_energy, b.settled.mean_energy);
  EXPECT_EQ(a.settled.stick_fraction, b.settled.stick_fraction);
  ASSERT_EQ(a.settled.slips.size(), b.settled.slips.size());
  for (std::size_t k = 0; k < a.settled.slips.size(); ++k) {
    EXPECT_EQ(a.settled.slips[k].time, b.settled.slips[k].time);
    EXPECT_EQ(a.settled.slips[k].displacement, b.settled.slips[k].displacement);
  }
}

void expect_same(const std::vector<SweepPoint>& a, const std::vector<SweepPoint>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) expect_same(a[i], b[i]);
}

TEST(SweepValues, RunFromOneEndToTheOther) {
  const std::vector<double> down = sweep_values(0.5, 0.001, 0.001);
  ASSERT_EQ(down.size(), 500u);
  EXPECT_EQ(down.front(), 0.5);
  EXPECT_NEAR(down.back(), 0.001, 1e-15);
  EXPECT_EQ(sweep_values(0.0, 1.0, -0.3).size(), 4u);  // the sign follows the range; 1.0 itself is not reached
  EXPECT_EQ(sweep_values(2.0, 2.0, 0.0), std::vector<double>{2.0});
  EXPECT_THROW((void)sweep_values(0.0, 1.0, 0.0), InvalidInput);
  EXPECT_THROW((void)sweep_values(0.0, std::nan(""), 0.1), InvalidInput);
  EXPECT_THROW((void)sweep_values(0.0, 1.0, 1e-9), InvalidInput);
}

TEST(Sweep, FollowsEachEndStateToTheNextValue) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const Model model = belt_model(system);
  const SweepResult found = sweep(model, kSpeeds, system.rest(), {.mode = SweepMode::kFollow, .settle = quick()});
  ASSERT_EQ(found.points.size(), kSpeeds.size());
  EXPECT_FALSE(found.interrupted);
  dynamics::State start = system.rest();
  for (std::size_t i = 0; i < kSpeeds.size(); ++i) {
    const Settled by_hand = settle(model.system(kSpeeds[i]), start, quick());
    EXPECT_TRUE(same_bytes(by_hand.end.q, found.points[i].settled.end.q)) << "speed " << kSpeeds[i];
    start = by_hand.end;
  }
}

TEST(Sweep, SegmentsAreChainsOfTheirOwn) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const Model model = belt_model(system);
  const dynamics::State start = system.rest();
  const SweepResult whole =
      sweep(model, kSpeeds, start, {.mode = SweepMode::kFollow, .segments = 2, .settle = quick()});
  const std::vector<double> second(kSpeeds.begin() + 3, kSpeeds.end());
  const SweepResult half = sweep(model, second, start, {.mode = SweepMode::kFollow, .settle = quick()});
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(same_bytes(whole.points[3 + i].settled.end.q, half.points[i].settled.end.q));
  }
}

TEST(Sweep, GivesTheSameBytesForAnyNumberOfThreads) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const dynamics::State start = system.rest();
  for (const SweepMode mode : {SweepMode::kIndependent, SweepMode::kFollow}) {
    SweepOptions options{.mode = mode, .segments = mode == SweepMode::kFollow ? 3u : 1u, .settle = quick()};
    options.parallel.threads = 1;
    // A model of its own each time: modal data are built by whichever thread comes first.
    const SweepResult one = sweep(belt_model(tests::chain10(0.2)), kSpeeds, start, options);
    for (const int threads : {2, 5}) {
      options.parallel.threads = threads;
      expect_same(sweep(belt_model(tests::chain10(0.2)), kSpeeds, start, options).points, one.points);
    }
  }
}

/// Keeps what is stored, as a file would, and stops the sweep after some points.
struct Journal {
  std::map<std::pair<std::size_t, int>, SweepPoint> kept = {};
  std::size_t stop_after = 1000;
  StopFlag stop = false;
  int asked = 0;

  [[nodiscard]] SweepSink sink() {
    return {.recall = [this](std::size_t index, int model) -> std::optional<SweepPoint> {
              ++asked;
              const auto found = kept.find({index, model});
              if (found == kept.end()) return std::nullopt;
              return found->second;
            },
            .store =
                [this](const SweepPoint& point) {
                  EXPECT_TRUE(kept.emplace(std::pair{point.index, point.model}, point).second)
                      << "value " << point.index << " was computed twice";
                  if (kept.size() >= stop_after) stop = true;
                }};
  }
};

TEST(Sweep, ResumesAfterAnInterruptWithTheSameBytes) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const Model model = belt_model(system);
  const dynamics::State start = system.rest();
  const SweepOptions plain{.mode = SweepMode::kFollow, .settle = quick()};
  const SweepResult whole = sweep(model, kSpeeds, start, plain);

  Journal journal{.stop_after = 3};
  SweepOptions options = plain;
  options.sink = journal.sink();
  options.parallel = {.threads = 1, .stop = &journal.stop};
  const SweepResult first = sweep(model, kSpeeds, start, options);
  EXPECT_TRUE(first.interrupted);
  EXPECT_EQ(first.points.size(), 3u);
  EXPECT_EQ(journal.kept.size(), 3u);

  journal.stop = false;
  journal.stop_after = 1000;
  const SweepResult second = sweep(model, kSpeeds, start, options);
  EXPECT_FALSE(second.interrupted);
  EXPECT_EQ(journal.kept.size(), kSpeeds.size());
  expect_same(second.points, whole.points);
}

TEST(Sweep, RefusesAJournalOfAnotherSweep) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  SweepOptions options{.settle = quick()};
  options.sink.recall = [](std::size_t index, int model) -> std::optional<SweepPoint> {
    return SweepPoint{.index = index, .model = model, .parameter = 0.123};
  };
  EXPECT_THROW((void)sweep(belt_model(system), kSpeeds, system.rest(), options), InvalidInput);
}

TEST(Sweep, RecordsAValueThatFailsAndGoesOnFromItsStart) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  Model model = belt_model(system);
  const dynamics::SystemFamily sound = model.system;
  model.system = [sound](double speed) {
    if (speed == 0.35) throw NumericalFailure("made to fail at 0.35", 12.0, {}, 0.0);
    return sound(speed);
  };
  const SweepResult found = sweep(model, kSpeeds, system.rest(), {.mode = SweepMode::kFollow, .settle = quick()});
  ASSERT_EQ(found.points.size(), kSpeeds.size());
  EXPECT_FALSE(found.interrupted);
  EXPECT_EQ(found.points[2].failure, "made to fail at 0.35");
  for (const std::size_t i : {0u, 1u, 3u, 4u, 5u}) EXPECT_TRUE(found.points[i].ok());
  const Settled after = settle(sound(kSpeeds[3]), found.points[1].settled.end, quick());
  EXPECT_TRUE(same_bytes(after.end.q, found.points[3].settled.end.q));
}

TEST(Sweep, EndsOnWhatTheUserMustMend) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const dynamics::State wrong{0.0, Eigen::VectorXd::Zero(3), Eigen::VectorXd::Zero(3), {}};
  EXPECT_THROW((void)sweep(belt_model(system), kSpeeds, wrong, {.settle = quick()}), InvalidInput);
  EXPECT_THROW((void)sweep(belt_model(system), {}, system.rest(), {}), InvalidInput);
  EXPECT_THROW((void)sweep(belt_model(system), kSpeeds, system.rest(), {.segments = 7}), InvalidInput);
}

TEST(PairedSweep, StartsBothModelsFromTheReducedEndState) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const dynamics::Trajectory run = dynamics::simulate(system, system.rest(), {.duration = 2000.0, .sample = 0.5});
  const pod::Basis basis = pod::pod({.snapshots = run.q}, {.choice = {.modes = 6}}).basis;
  const Model full = belt_model(system);
  const Model reduced = reduced_belt_model(system, basis);
  const dynamics::State start = rom::restrict_state(system.structure(), basis, system.rest());

  SweepOptions options{.mode = SweepMode::kFollow, .settle = quick(), .parallel = {.threads = 2}};
  const PairedSweep found = paired_sweep(full, reduced, kSpeeds, start, options);
  ASSERT_EQ(found.full.size(), kSpeeds.size());
  ASSERT_EQ(found.reduced.size(), kSpeeds.size());
  dynamics::State from = start;
  for (std::size_t i = 0; i < kSpeeds.size(); ++i) {
    EXPECT_EQ(found.full[i].model, 0);
    EXPECT_EQ(found.reduced[i].model, 1);
    const Settled r = settle(reduced.system(kSpeeds[i]), from, quick());
    const Settled f = settle(full.system(kSpeeds[i]), rom::lift(basis, from), quick());
    EXPECT_TRUE(same_bytes(r.end.q, found.reduced[i].settled.end.q));
    EXPECT_TRUE(same_bytes(f.end.q, found.full[i].settled.end.q));
    EXPECT_EQ(found.reduced[i].settled.mean_energy, r.mean_energy + energy_offset_at(reduced, kSpeeds[i]));
    from = r.end;
  }

  options.parallel.threads = 1;
  const PairedSweep alone = paired_sweep(full, reduced, kSpeeds, start, options);
  expect_same(alone.full, found.full);
  expect_same(alone.reduced, found.reduced);
  EXPECT_THROW((void)paired_sweep(full, full, kSpeeds, start, options), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
