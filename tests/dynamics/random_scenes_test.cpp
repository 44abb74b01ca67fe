// Every regime change agrees with its law, over random scenes: forces recomputed from the state by dense algebra
// (tests/fixtures/contact_forces.hpp), signs checked on dense samples, events counted by the Taylor reference.
#include "fixtures/against_reference.hpp"
#include "fixtures/contact_forces.hpp"

#include <gtest/gtest.h>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;

/// The modes of every contact along a run, rebuilt from its events.
class Timeline {
 public:
  Timeline(const Trajectory& run, std::size_t contacts) : modes_(contacts), changes_(mode_changes(run.events)) {
    for (std::size_t c = 0; c < contacts; ++c) {
      modes_[c] = static_cast<int>(run.final_state.modes[c]);
      for (std::size_t i = changes_.size(); i-- > 0;) {
        if (changes_[i].contact == static_cast<int>(c)) modes_[c] = changes_[i].before;
      }
    }
  }
  /// Moves to time t (later than before) and returns the modes there.
  const std::vector<int>& at(double t) {
    for (; next_ < changes_.size() && changes_[next_].time <= t; ++next_) {
      const auto& change = changes_[next_];
      if (modes_[change.contact] != change.before) broken_ = true;
      modes_[change.contact] = change.after;
    }
    return modes_;
  }
  [[nodiscard]] bool broken() const { return broken_; }

 private:
  std::vector<int> modes_;
  std::vector<ReferenceEvent> changes_;
  std::size_t next_ = 0;
  bool broken_ = false;
};

/// Samples between events: stick holds, slip keeps its sign, λ is the law's.
void expect_lawful_samples(const HybridSystem& system, const Trajectory& run) {
  const auto& contacts = system.contacts();
  Timeline timeline(run, contacts.size());
  const double speed = 1.0 + run.contact_v.cwiseAbs().maxCoeff();
  for (Eigen::Index k = 0; k < run.times.size(); ++k) {
    const double belt = system.drive().velocity(run.times[k]);
    const auto& modes = timeline.at(run.times[k]);
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const double slip = belt - run.contact_v(c, k), lambda = run.lambda(c, k), limit = static_limit(contacts[c]);
      const auto where = [&] { return ::testing::Message() << "contact " << c << " at t = " << run.times[k]; };
      if (modes[c] == 0) {
        ASSERT_LE(std::abs(slip), 1e-12 * speed) << where();
        ASSERT_LE(std::abs(lambda), limit * (1.0 + 1e-9)) << where();
        continue;
      }
      if (modes[c] != 2) {
        ASSERT_GE(modes[c] * slip, -1e-10 * speed) << where();
      }
      ASSERT_NEAR(lambda, sliding_force(contacts[c], slip, modes[c]), 1e-8 * std::max(limit, 1e-3)) << where();
    }
  }
  EXPECT_FALSE(timeline.broken()) << "an event's `before` is not the mode the contact was in";
}

/// At every instant with events: stuck contacts within their limit, slips that begin at v_rel = 0 go their own way,
/// releases at the limit, and v_rel = 0 to rounding.
void expect_lawful_events(const HybridSystem& system, const Trajectory& run) {
  const ReferenceModel model = reference_of(system);
  Timeline timeline(run, system.contacts().size());
  const double speed = 1.0 + run.contact_v.cwiseAbs().maxCoeff();
  std::vector<int> before = timeline.at(-1.0);
  for (std::size_t i = 0; i < run.events.size(); ++i) {
    const double t = run.events[i].time;
    const auto column = static_cast<Eigen::Index>(i);
    const std::vector<int> after = timeline.at(t);
    const double belt = system.drive().velocity(t), ramp = system.drive().acceleration(t);
    const Forces forces = contact_forces(model, run.event_q.col(column), run.event_v.col(column), after, belt, ramp);
    const Forces held = contact_forces(model, run.event_q.col(column), run.event_v.col(column), before, belt, ramp);
    bool alone = true;
    for (std::size_t j = 0; j < run.events.size(); ++j) alone = alone && (j == i || run.events[j].time != t);
    for (; i < run.events.size() && run.events[i].time == t; ++i) {
      const Event& event = run.events[i];
      if (event.contact < 0) continue;
      const auto& contact = system.contacts()[event.contact];
      const double limit = static_limit(contact);
      const auto where = [&] { return ::testing::Message() << "contact " << event.contact << " at t = " << t; };
      ASSERT_LE(std::abs(belt - event.velocity), 1e-10 * speed) << where();
      if (event.after == ContactMode::kStick) {
        ASSERT_EQ(event.kind, EventKind::kStick) << where();
        ASSERT_LE(std::abs(forces.lambda[event.contact]), limit * (1.0 + 1e-9)) << where();
      } else if (event.before != event.after) {
        const bool released = event.before == ContactMode::kStick;
        ASSERT_EQ(event.kind, released ? EventKind::kRelease : EventKind::kReversal) << where();
        if (released && alone) {
          ASSERT_NEAR(std::abs(held.lambda[event.contact]), limit, 1e-8 * limit) << where();
        }
        const double departure = static_cast<int>(event.after) * forces.slip_rate[event.contact];
        ASSERT_GE(departure, -1e-8 * (1.0 + held.acceleration.cwiseAbs().maxCoeff())) << where();
      }
      ASSERT_NEAR(event.force, forces.lambda[event.contact], 1e-7 * std::max(limit, 1e-3)) << where();
    }
    --i;
    before = after;
  }
}

TEST(RandomScenes, EveryRegimeChangeAgreesWithItsLawInAThousandScenes) {
  std::size_t events = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = random_scene(seed);
    const Trajectory run =
        simulate(scene.system, scene.start, {.duration = 10.0, .sample = 0.03, .event_states = true});
    expect_lawful_samples(scene.system, run);
    expect_lawful_events(scene.system, run);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-9);
    events += run.events.size();
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(events, 3000u) << "the scenes are too quiet to mean anything";
}

TEST(RandomScenes, ClosedFormIsLawfulToo) {
  for (std::uint64_t seed = 5000; seed < 5100; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = random_scene(seed, Laws::kCoulombOnly, 20);
    const Trajectory run =
        simulate(scene.system, scene.start,
                 {.duration = 10.0, .sample = 0.03, .event_states = true, .flow = {.method = FlowMethod::kClosedForm}});
    expect_lawful_samples(scene.system, run);
    expect_lawful_events(scene.system, run);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-9);
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(RandomScenes, NoEventIsMissedBesideAScanAHundredTimesFiner) {
  for (std::uint64_t seed = 2000; seed < 2030; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = random_scene(seed, Laws::kAll, 15);
    const Trajectory run = simulate(
        scene.system, scene.start,
        {.duration = 10.0, .sample = 3e-4, .event_states = false, .output = SimulateOptions::Output::kAllDofs});
    expect_lawful_samples(scene.system, run);
    if (::testing::Test::HasFailure()) return;
  }
}

void expect_events_of_the_reference(std::uint64_t first_seed, std::uint64_t count, int max_masses) {
  std::size_t events = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + count; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const bool coulomb = seed % 3 == 0;
    const RandomScene scene = random_scene(seed, coulomb ? Laws::kCoulombOnly : Laws::kAll, max_masses);
    const FlowOptions flow{.method = coulomb ? FlowMethod::kClosedForm : FlowMethod::kCollocation, .tolerance = 1e-13};
    events += expect_near_reference(scene.system, scene.start, 8.0, flow);
  }
  EXPECT_GT(events, 2 * count) << "the scenes are too quiet to mean anything";
}

TEST(RandomScenes, EventsAreThoseOfTheReference) { expect_events_of_the_reference(3000, 300, 8); }

TEST(RandomScenes, EventsOfLargeScenesAreThoseOfTheReference) { expect_events_of_the_reference(4000, 60, 50); }

}  // namespace
}  // namespace slipmode::dynamics
