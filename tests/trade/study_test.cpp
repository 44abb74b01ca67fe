// Configurations of small scenes, measured.

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/validation/compare.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/trade/case.hpp>
#include <slipmode/trade/effects.hpp>
#include <slipmode/trade/study.hpp>
#include <slipmode/trade/variants.hpp>
#include "cli/small_scenes.hpp"
#include "trade/internal/horizon.hpp"
#include "trade/internal/motion.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <string>
#include <vector>

namespace slipmode::trade {
namespace {

const std::string kBeam = R"(
units = "SI"
[structure]
kind = "beam"
theory = "timoshenko"
length = 0.4
width = 0.02
thickness = 0.02
youngs_modulus = 128e9
density = 7488.0
elements = 6
[structure.damping]
modal_ratio = 0.01
[[contact]]
at = "tip"
law = "compliant"
mu_k = 0.4
mu_s = 0.5
stiffness = 2e6
normal_load = { constant = 40.0, slope = -1e4 }
tilt_deg = 0.3
[drive]
kind = "shaker"
frequency = 60.0
amplitude = 1e-4
[time]
cycles = 40
transient_cycles = 20
samples_per_cycle = 32
[validation]
cycles = 40
kept = 20
modes = [1, 5, 12]
cost_repeats = 1
)";

std::vector<std::string> names(const std::vector<Axis>& axes) {
  std::vector<std::string> out;
  for (const Axis axis : axes) out.emplace_back(to_string(axis));
  return out;
}

std::vector<OfferedBasis> natural_modes_of(const scene::Scene& scene) {
  const fem::Structure structure = scene::build_system(scene).structure();
  return {{.choice = scene::BasisChoice::kLnm, .basis = rom::lnm_basis(structure, structure.size())}};
}

const Row& row_of(const Study& study, const std::string& name) {
  const auto found = std::ranges::find(study.rows, name, [](const Row& row) { return row.variant.name; });
  if (found == study.rows.end()) throw InvalidInput("no row " + name);
  return *found;
}

TEST(Variants, AreAlongTheAxesTheSceneHas) {
  const std::vector<std::string> chain = {"modes", "flow", "law"};
  EXPECT_EQ(names(axes_of(scene::parse_scene(tests::kFreeEnds))), chain);
  // A compliant, tilted contact is not offered the other flow, and no regularised law.
  const scene::Scene beam = scene::parse_scene(kBeam);
  const std::vector<std::string> shaken = {"modes", "theory", "elements", "law", "load"};
  EXPECT_EQ(names(axes_of(beam)), shaken);
  for (const Variant& variant : along(Axis::kLaw, beam, {})) EXPECT_EQ(variant.name.find("tanh"), std::string::npos);
  try {
    (void)parse_axes("law,flow", axes_of(beam));
    FAIL() << "an axis the scene does not have was taken";
  } catch (const InvalidInput& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("valid: modes, theory, elements, law, load"), std::string::npos);
  }
}

TEST(Variants, AreScenesThatReadBack) {
  for (const scene::Scene& scene : {scene::parse_scene(tests::kFreeEnds), scene::parse_scene(kBeam)}) {
    for (const Axis axis : axes_of(scene)) {
      for (const Variant& variant : along(axis, scene, natural_modes_of(scene))) {
        const scene::Scene back = scene::parse_scene(scene_text(variant));
        EXPECT_EQ(scene_text(as_it_stands(back)), scene_text(variant)) << variant.name;
        EXPECT_EQ(back.size(), variant.scene.size()) << variant.name;
        if (!variant.reduction) continue;
        EXPECT_EQ(back.reduction.basis, variant.reduction->basis) << variant.name;
        EXPECT_EQ(back.reduction.choice.modes, variant.reduction->modes) << variant.name;
      }
    }
  }
  // What the scene never had is not asked of `run` by the written one.
  const std::string plain = scene_text(as_it_stands(scene::parse_scene(tests::kTwoContacts)));
  for (const char* table : {"[validation]", "[ensemble]", "[reduction]"}) {
    EXPECT_EQ(plain.find(table), std::string::npos) << table;
  }
}

TEST(Horizon, GivesTheDeviationsOfValidation) {
  // diagnostics::deviation over the same records, run by hand: another path to the same two numbers.
  const scene::Scene scene = scene::parse_scene(tests::kFreeEnds);
  const std::vector<OfferedBasis> bases = natural_modes_of(scene);
  const Case full = build_case(as_it_stands(scene), bases);
  const Case reduced =
      build_case({.name = "2 LNM", .scene = scene, .reduction = Reduction{scene::BasisChoice::kLnm, 2}}, bases);
  Schedule schedule = schedule_of(scene);
  schedule.horizon_sample = 0.05;
  const std::vector<dynamics::State> starts = states_of(full, scene::initial_state(scene, full.full), 3, schedule.gap);
  const HorizonDeviation found = horizon_deviation(full, reduced, starts, schedule);

  const auto steps = static_cast<Eigen::Index>(std::llround(schedule.horizon / schedule.horizon_sample));
  diagnostics::Record a{Eigen::MatrixXd(3, 3 * steps), Eigen::MatrixXd(3, 3 * steps)}, b = a;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const dynamics::State own = handed_on(full, reduced, starts[static_cast<std::size_t>(k)]);
    const dynamics::SimulateOptions options{
        .duration = schedule.horizon, .sample = schedule.horizon_sample, .flow = scene.flow};
    const auto run = dynamics::simulate(full.full, rom::lift(*reduced.basis, own), options);
    const auto other = dynamics::simulate(reduced.model.system, own, options);
    a.q.middleCols(k * steps, steps) = run.q.leftCols(steps);
    a.v.middleCols(k * steps, steps) = run.v.leftCols(steps);
    b.q.middleCols(k * steps, steps) = reduced.basis->vectors * other.q.leftCols(steps);
    b.v.middleCols(k * steps, steps) = reduced.basis->vectors * other.v.leftCols(steps);
  }
  const diagnostics::Deviation expected = diagnostics::deviation(full.full.structure(), a, b);
  EXPECT_NEAR(found.dX, expected.dX, 1e-6 * expected.dX);
  EXPECT_NEAR(found.dE, expected.dE, 1e-6 * expected.dX);
  EXPECT_GT(found.dX_scatter, 0.0);
}

TEST(Motions, DistancesHaveClosedForms) {
  // Readings 0, 2, 0, 2, … have rms 1; all moved by 0.3 they are 30 % of it away.
  Motion a{.points = {1.0, 3.0}, .readings = {0.0, 2.0, 0.0, 2.0}, .energy = 4.0, .stick = 0.25, .end = {}};
  Motion b{.points = {1.5, 3.5}, .readings = {0.3, 2.3, 0.3, 2.3}, .energy = 5.0, .stick = 0.5, .end = {}};
  const Values values = motion_distance(a, b);
  EXPECT_NEAR(at(values, Measure::kPoints), 50.0, 1e-12);
  EXPECT_NEAR(at(values, Measure::kSpread), 30.0, 1e-12);
  EXPECT_NEAR(at(values, Measure::kEnergy), 25.0, 1e-12);
  EXPECT_NEAR(at(values, Measure::kStick), 25.0, 1e-12);
  EXPECT_TRUE(std::isnan(at(values, Measure::kDx)));
  // Three motions, two of them alike: of the three pairs two are 30 % apart.
  EXPECT_NEAR(
      at(motion_scatter({a, a, {.points = {}, .readings = b.readings, .energy = 4.0, .stick = 0.25, .end = {}}}),
         Measure::kSpread),
      30.0 * std::sqrt(2.0 / 3.0), 1e-9);
}

TEST(Study, AllModesAreTheFullModelAndFewerAreFurtherAway) {
  scene::Scene scene = scene::parse_scene(tests::kFreeEnds);
  scene.validation.limit = 200.0;  // the motion need not be compared for long: all modes give the same one
  const std::vector<OfferedBasis> bases = natural_modes_of(scene);
  std::vector<Variant> variants = {as_it_stands(scene)};
  for (const Axis axis : {Axis::kModes, Axis::kLaw}) {
    std::ranges::move(along(axis, scene, bases), std::back_inserter(variants));
  }
  StudyOptions options{.schedule = schedule_of(scene)};
  options.schedule.runs = 2;
  const Study done = study(scene, reference_of(scene), variants, bases, options);
  for (const Row& row : done.rows) EXPECT_EQ(row.failure, "") << row.variant.name;
  const auto dX = [&](const std::string& name) { return at(row_of(done, name).error, Measure::kDx); };
  EXPECT_LT(dX("3 LNM"), 1e-4) << "all modes; tolerance 1e-9 against 1e-12 over 10 units";
  EXPECT_LT(dX("scene as it stands"), 1e-4);
  // Mode 2 of three masses is antisymmetric and the contact is in the middle: friction never moves it, and what the
  // starts give it decays (2e-5 of dX are left).
  EXPECT_NEAR(dX("1 LNM"), dX("2 LNM"), 1e-3 * dX("1 LNM"));
  EXPECT_GT(dX("2 LNM"), 1.0);
  // The regularised law's error is of the order of ε (dynamics' own statement): a tenth of it, a tenth of that.
  const double ratio = dX("tanh, eps 0.02") / dX("tanh, eps 0.002");
  EXPECT_GT(ratio, 3.0);
  EXPECT_LT(ratio, 30.0);
  EXPECT_TRUE(std::isnan(at(row_of(done, "tanh, eps 0.02").error, Measure::kStick))) << "it has no stick to compare";
  for (const Row& row : done.rows) EXPECT_GT(row.cost.cpu, 0.0) << row.variant.name;
}

// One mass on a belt beyond its Hopf point, V = ln(98)/12 = 0.382, and before the fold of its stick-slip motion, V
// = 1.502: sliding and stick-slip are both stable, and a start between them goes to one or the other.
TEST(Study, ScatterIsThatOfTheScenesOwnMotionWhereOthersAreStableBesideIt) {
  scene::Scene scene = scene::parse_scene(R"(
units = "SI"
[structure]
kind = "chain"
masses = 1
mass = 2.5
stiffness = 1600.0
damping = 3.75e-4
ends = "fixed-free"
[[contact]]
at = 1
law = "stribeck"
mu_s = 0.5
mu_k = 0.3
alpha = 12.0
normal_load = 24.5
[drive]
kind = "belt"
speed = 1.3
[initial]
displacement = [0.06]
velocity = [0.0]
[ensemble]
spread = 0.01
)");
  const StudyOptions options{.schedule = schedule_of(scene::with_own_times(scene))};
  const auto of = [&](double displacement) {
    scene.initial.displacement = {displacement};
    return study(scene, reference_of(scene), {as_it_stands(scene)}, {}, options);
  };
  const Study mixed = of(0.06);
  EXPECT_EQ(mixed.elsewhere, 1U);
  EXPECT_EQ(mixed.shared_starts, 3U * static_cast<std::size_t>(options.schedule.starts)) << "along the other three";
  EXPECT_LT(at(mixed.reference.noise, Measure::kEnergy), 1e-3) << "of stick-slip alone, which is periodic";
  EXPECT_FALSE(mixed.dies_out);
  const Study alone = of(0.2);
  EXPECT_EQ(alone.elsewhere, 0U);
}

TEST(Study, OfAMotionThatDiesOutIsFromTheScenesStartOn) {
  // A block that slides to rest in closed form: where it rests nothing is left to divide by.
  const scene::Scene scene =
      scene::with_own_times(scene::load_scene(SLIPMODE_SOURCE_DIR "/datasets/coulomb_decay/scene.toml"));
  const StudyOptions options{.schedule = schedule_of(scene)};
  const Study found = study(scene, reference_of(scene), {as_it_stands(scene)}, {}, options);
  EXPECT_TRUE(found.dies_out);
  EXPECT_EQ(found.shared_starts, static_cast<std::size_t>(options.schedule.runs));
  EXPECT_EQ(at(found.rows[0].error, Measure::kDx), 0.0);
  for (const Measure measure : {Measure::kPoints, Measure::kSpread, Measure::kEnergy, Measure::kStick})
    EXPECT_TRUE(std::isnan(at(found.rows[0].error, measure)));
  EXPECT_EQ(recommendations(found, 1.0).size(), 2U) << "dX and dE";
  // Let go within reach of friction, k |x| < mu N, it never moves.
  scene::Scene still = scene;
  still.initial.displacement[0] = 0.5e-4;
  EXPECT_THROW((void)study(still, reference_of(still), {as_it_stands(still)}, {}, options), InvalidInput);
}

TEST(Study, IsTheSameForAnyNumberOfThreadsAndGoesOnWhereItStopped) {
  scene::Scene scene = scene::parse_scene(tests::kFreeEnds);
  scene.validation.limit = 400.0;
  const std::vector<OfferedBasis> bases = natural_modes_of(scene);
  std::vector<Variant> variants = {as_it_stands(scene)};
  std::ranges::move(along(Axis::kModes, scene, bases), std::back_inserter(variants));
  StudyOptions options{.schedule = schedule_of(scene)};
  options.schedule.runs = 2;
  std::vector<std::pair<std::string, Finished>> kept;
  options.parallel.threads = 1;
  options.store = [&](const std::string& name, const Finished& found) { kept.emplace_back(name, found); };
  const Study one = study(scene, reference_of(scene), variants, bases, options);
  ASSERT_EQ(kept.size(), variants.size());
  options.parallel.threads = 3;
  options.store = {};
  const Study three = study(scene, reference_of(scene), variants, bases, options);
  // Errors that nobody would compute show that they were taken over.
  kept[1].second.error.fill(123.0);
  options.recall = [&](const std::string& name) -> std::optional<Finished> {
    if (name == kept[1].first) return kept[1].second;
    return std::nullopt;
  };
  const Study resumed = study(scene, reference_of(scene), variants, bases, options);
  for (std::size_t i = 0; i < variants.size(); ++i) {
    EXPECT_EQ(one.rows[i].error, three.rows[i].error) << variants[i].name;
    if (i != 1) {
      EXPECT_EQ(one.rows[i].error, resumed.rows[i].error) << variants[i].name;
    }
  }
  EXPECT_EQ(resumed.rows[1].error, kept[1].second.error);
}

TEST(Cases, AStateSurvivesTheWayToAFinerMeshAndBack) {
  // Euler-Bernoulli elements are cubic: on halved elements the same deflection, strain energy and curvature exist.
  scene::Scene scene = scene::parse_scene(kBeam, {"structure.theory=euler-bernoulli"});
  scene::Scene finer = scene;
  std::get<fem::BeamOptions>(finer.structure).spans.front().elements *= 2;
  const Case a = build_case(as_it_stands(scene), {}), b = build_case(as_it_stands(finer), {});
  dynamics::State state = a.full.rest();
  for (Eigen::Index i = 0; i < state.q.size(); ++i) state.q(i) = 1e-3 * std::sin(1.0 + static_cast<double>(i));
  const dynamics::State there = handed_on(a, b, state);
  const dynamics::State back = handed_on(b, a, there);
  EXPECT_LT((back.q - state.q).norm(), 1e-12 * state.q.norm());
  const double energy = a.full.energy(state);
  EXPECT_NEAR(b.full.energy({.q = there.q, .v = there.v}), energy, 1e-9 * energy);
}

TEST(Motions, ChangesHaveTheScatterOfTheirRuns) {
  // Energies 4, 4, 4 become 5, 6, 4: a mean change of 1 = 25 %, of standard error 1/sqrt(3) = 14.4 %, whose square is
  // taken off: sqrt(1 - 1/3) = 20.4 %. All readings move by 0.3 of an rms of 1, in every run: 30 % without scatter.
  const auto motion = [](double energy, double moved) {
    return Motion{
        .points = {}, .readings = {moved, 2.0 + moved, moved, 2.0 + moved}, .energy = energy, .stick = 0.25, .end = {}};
  };
  const MotionChange change = motion_change({motion(4.0, 0.0), motion(4.0, 0.0), motion(4.0, 0.0)},
                                            {motion(5.0, 0.3), motion(6.0, 0.3), motion(4.0, 0.3)});
  EXPECT_NEAR(at(change.error, Measure::kEnergy), 25.0 * std::sqrt(2.0 / 3.0), 1e-12);
  EXPECT_NEAR(at(change.noise, Measure::kEnergy), 25.0 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(at(change.error, Measure::kSpread), 30.0, 1e-12);
  EXPECT_NEAR(at(change.noise, Measure::kSpread), 0.0, 1e-12);
  EXPECT_EQ(at(change.error, Measure::kStick), 0.0);
  EXPECT_TRUE(std::isnan(at(change.error, Measure::kPoints)));
  EXPECT_THROW((void)motion_change({motion(4.0, 0.0)}, {motion(4.0, 0.0)}), InvalidInput);
}

/// Names of all but modes and elements.
std::vector<std::string> effects_named(const std::string& text, const std::vector<std::string>& overrides) {
  std::vector<std::string> out;
  for (const Effect& effect : effects_of(scene::parse_scene(text, overrides))) {
    if (effect.kind != EffectKind::kDiscretisation) out.push_back(effect.name);
  }
  return out;
}

TEST(Effects, AreThoseTheSceneNamesAndCouldName) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(effects_named(kBeam, {}),
            (Names{"contact compliance", "static friction peak", "position-dependent load", "tilt of the slider",
                   "structural damping", "shear", "rotary inertia", "Timoshenko's theory"}));
  EXPECT_EQ(effects_named(kBeam, {"structure.theory=euler-bernoulli", "contact.0.tilt_deg=0.0"}),
            (Names{"contact compliance", "static friction peak", "position-dependent load", "structural damping",
                   "Timoshenko's theory"}));
  EXPECT_EQ(effects_named(tests::kFreeEnds, {}), (Names{"static friction peak", "Stribeck slope", "structural damping",
                                                        "tolerance below 1e-06", "tolerance below 1e-03"}));
  EXPECT_EQ(effects_named(tests::kTwoContacts, {}),
            (Names{"static friction peak of contact 1", "static friction peak of contact 2", "structural damping",
                   "springs behind rigid contacts"}));
  EXPECT_EQ(effects_named(tests::kTwoContacts, {"structure.damping=0.0", "contact.0.mu_s=0.3"}),
            (Names{"static friction peak", "springs behind rigid contacts"}));
}

TEST(Effects, OfDiscretisationAreLadders) {
  std::vector<std::string> found;
  for (const Effect& effect : effects_of(scene::parse_scene(kBeam))) {
    if (effect.ladder == "elements") found.push_back(effect.name);
  }
  EXPECT_EQ(found, (std::vector<std::string>{"more than 3 elements", "more than 2 elements", "more than 1 elements"}))
      << "6 elements: a half, a quarter and an eighth of them, rounded";
}

TEST(Effects, LeftOutTogetherAreOneScene) {
  const scene::Scene scene = scene::parse_scene(kBeam);
  const std::vector<Effect> effects = effects_of(scene);
  const auto number = [&](const std::string& name) {
    const auto found = std::ranges::find(effects, name, &Effect::name);
    if (found == effects.end()) throw InvalidInput("no effect " + name);
    return static_cast<std::size_t>(found - effects.begin());
  };
  const Variant lean =
      without(scene, effects,
              {number("static friction peak"), number("tilt of the slider"), number("Timoshenko's theory"),
               number("more than 3 elements"), number("modes above 2")});
  EXPECT_EQ(lean.scene.contacts.front().tilt_deg, 0.0);
  EXPECT_EQ(std::get<friction::CompliantCoulomb>(lean.scene.contacts.front().law).mu_s, 0.4);
  EXPECT_EQ(lean.scene.beam()->theory, fem::BeamTheory::kEulerBernoulli);
  EXPECT_EQ(lean.scene.size(), 6);
  ASSERT_TRUE(lean.reduction);
  EXPECT_EQ(lean.reduction->modes, 2);
  EXPECT_EQ(build_case(lean, {}).model.system.size(), 2);
}

TEST(Effects, ShearAndRotaryInertiaDroppedOneByOneLeaveEulersBeam) {
  const scene::Scene scene = scene::parse_scene(kBeam);
  const auto lacking = [](const scene::Scene& from, const std::string& name) {
    for (const Effect& effect : effects_of(from)) {
      if (effect.name == name) return effect.change(from);
    }
    throw InvalidInput("no effect " + name);
  };
  const auto omega = [](const scene::Scene& from) {
    return Eigen::VectorXd(fem::natural_modes(scene::build_system(from).structure(), 4).omega);
  };
  const Eigen::VectorXd both = omega(scene);
  const Eigen::VectorXd no_shear = omega(lacking(scene, "shear"));
  const Eigen::VectorXd no_rotary = omega(lacking(scene, "rotary inertia"));
  const Eigen::VectorXd neither = omega(lacking(lacking(scene, "rotary inertia"), "shear"));
  const Eigen::VectorXd euler = omega(lacking(scene, "Timoshenko's theory"));
  for (Eigen::Index k = 0; k < 4; ++k) {
    EXPECT_LT(both(k), no_shear(k)) << "shear makes a beam softer";
    EXPECT_LT(both(k), no_rotary(k)) << "rotary inertia makes it slower";
    EXPECT_GT(no_rotary(k) / both(k) - 1.0, 1e-5);
    EXPECT_NEAR(neither(k), euler(k), 1e-6 * euler(k));
  }
}

TEST(Effects, NotNamedAreNotBuilt) {
  // Two contacts without springs, loads that vary, tilt or forces: no states beside q and q̇, nothing constant, no
  // directions. The matrices of a rigid contact depend on whether it sticks: four regimes can exist, and one is built
  // for each that the run visits, told here by its events. A second run, under another drive, has them already.
  const scene::Scene scene = scene::parse_scene(tests::kTwoContacts);
  const dynamics::HybridSystem system = scene::build_system(scene);
  EXPECT_EQ(system.internal_size(), 0);
  EXPECT_EQ(system.load().size(), 0);
  EXPECT_EQ(system.force_directions().cols(), 0);
  const dynamics::SimulateOptions options{.duration = 40.0};
  const auto first = dynamics::simulate(system, scene::initial_state(scene, system), options);
  std::array<bool, 2> sticks{};
  for (auto event = first.events.rbegin(); event != first.events.rend(); ++event) {
    sticks[static_cast<std::size_t>(event->contact)] = event->before == dynamics::ContactMode::kStick;
  }
  std::set<std::array<bool, 2>> visited = {sticks};
  for (std::size_t i = 0; i < first.events.size(); ++i) {
    const dynamics::Event& event = first.events[i];
    sticks[static_cast<std::size_t>(event.contact)] = event.after == dynamics::ContactMode::kStick;
    const bool together = i + 1 < first.events.size() && first.events[i + 1].time == event.time;
    if (!together) visited.insert(sticks);
  }
  EXPECT_GT(first.events.size(), 4U);
  EXPECT_EQ(static_cast<std::size_t>(first.statistics.regimes_built), visited.size());
  const auto again = dynamics::simulate(system.with_drive(friction::Belt::constant(0.1)),
                                        scene::initial_state(scene, system), options);
  EXPECT_EQ(again.final_state.q, first.final_state.q);

  // The same contacts with springs carry their stretch: what a scene names, it pays for.
  const scene::Scene springs = scene::parse_scene(
      tests::kTwoContacts,
      {"contact.0.law=compliant", "contact.0.stiffness=1e4", "contact.1.law=compliant", "contact.1.stiffness=1e4"});
  EXPECT_EQ(scene::build_system(springs).internal_size(), 2);
}

}  // namespace
}  // namespace slipmode::trade
