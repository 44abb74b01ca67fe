#include <slipmode/core/errors.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include "results/stored_systems.hpp"
#include "scene/messages.hpp"
#include "scene/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

namespace {

using namespace slipmode;
using namespace slipmode::results;
using slipmode::tests::expect_parts;
using slipmode::tests::expect_same_system;
using slipmode::tests::message_of;
using slipmode::tests::read_back;
using slipmode::tests::TemporaryFolder;
using slipmode::tests::written;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

pod::Basis some_basis() {
  pod::Basis basis;
  basis.vectors = Eigen::MatrixXd::Random(5, 2);
  basis.mean = Eigen::VectorXd::Random(5);
  basis.energy = Eigen::VectorXd{{0.9, 0.1}};
  basis.kind = pod::BasisKind::kPom;
  basis.provenance = "from a test";
  return basis;
}

TEST(Records, TrajectoryReadsBackToTheSameBits) {
  dynamics::Trajectory run;
  run.events = {{1.5, 0, dynamics::EventKind::kRelease, dynamics::ContactMode::kStick,
                 dynamics::ContactMode::kSlipNegative, 0.1, 0.2, -0.3},
                {2.5, -1, dynamics::EventKind::kDriveCorner, dynamics::ContactMode::kSmooth,
                 dynamics::ContactMode::kSmooth, 0.4, 0.5, 0.6}};
  run.times = Eigen::VectorXd::LinSpaced(4, 0.0, 3.0);
  run.q = Eigen::MatrixXd::Random(3, 4);
  run.v = Eigen::MatrixXd::Random(3, 4);
  run.contact_q = Eigen::MatrixXd::Random(2, 4);
  run.contact_v = Eigen::MatrixXd::Random(2, 4);
  run.lambda = Eigen::MatrixXd::Random(2, 4);
  run.event_q = Eigen::MatrixXd::Random(3, 2);
  run.event_v = Eigen::MatrixXd::Random(3, 2);
  run.final_state = {3.0,
                     Eigen::VectorXd::Random(3),
                     Eigen::VectorXd::Random(3),
                     {dynamics::ContactMode::kStick, dynamics::ContactMode::kSlipPositive}};
  run.audit.energy_end = 2.0;
  run.audit.exchanged = 7.0;
  run.statistics.steps = 12345678901LL;
  run.statistics.stick_time = {0.5, 0.25};

  const TemporaryFolder folder;
  const auto back = load_trajectory(written(folder, [&](StoreWriter& out) { save(out, "trajectory", run); }));
  ASSERT_EQ(back.events.size(), 2U);
  EXPECT_EQ(back.events[0].after, dynamics::ContactMode::kSlipNegative);
  EXPECT_EQ(back.events[1].contact, -1);
  EXPECT_EQ(back.events[1].kind, dynamics::EventKind::kDriveCorner);
  EXPECT_EQ(back.events[0].force, -0.3);
  EXPECT_EQ(back.times, run.times);
  EXPECT_EQ(back.q, run.q);
  EXPECT_EQ(back.v, run.v);
  EXPECT_EQ(back.contact_q, run.contact_q);
  EXPECT_EQ(back.contact_v, run.contact_v);
  EXPECT_EQ(back.lambda, run.lambda);
  EXPECT_EQ(back.event_q, run.event_q);
  EXPECT_EQ(back.event_v, run.event_v);
  EXPECT_EQ(back.final_state.q, run.final_state.q);
  EXPECT_EQ(back.final_state.modes, run.final_state.modes);
  EXPECT_EQ(back.audit.energy_end, 2.0);
  EXPECT_EQ(back.audit.exchanged, 7.0);
  EXPECT_EQ(back.statistics.steps, 12345678901LL);
  EXPECT_EQ(back.statistics.stick_time, run.statistics.stick_time);
}

TEST(Records, TrajectoryIsTimeByQuantity) {
  dynamics::Trajectory run;
  run.times = Eigen::VectorXd::LinSpaced(4, 0.0, 3.0);
  run.q = run.v = Eigen::MatrixXd::Random(3, 4);
  run.audit.exchanged = 1.0;
  const TemporaryFolder folder;
  const auto in = written(folder, [&](StoreWriter& out) { save(out, "trajectory", run); });
  EXPECT_EQ(in.entry("trajectory/q").shape, (std::vector<std::int64_t>{4, 3}));
  EXPECT_EQ(in.entry("trajectory/q").meaning.units, "m");
  for (const StoreEntry& entry : in.entries()) EXPECT_FALSE(entry.meaning.description.empty()) << entry.name;
}

TEST(Records, EnsembleReadsBackAndMustBeFinite) {
  pod::Ensemble ensemble{Eigen::MatrixXd::Random(3, 10), {0, 4}};
  const TemporaryFolder folder;
  const auto back = load_ensemble(written(folder, [&](StoreWriter& out) { save(out, "ensemble", ensemble); }));
  EXPECT_EQ(back.snapshots, ensemble.snapshots);
  EXPECT_EQ(back.run_begin, ensemble.run_begin);
  ensemble.snapshots(1, 1) = kNaN;
  const auto bad = written(folder, [&](StoreWriter& out) { save(out, "ensemble", ensemble); });
  expect_parts(message_of([&] { (void)load_ensemble(bad); }),
               {"record.h5", "ensemble/snapshots", "NaN", "make the file"});
}

TEST(Records, BasisReadsBackToTheSameBits) {
  const pod::Basis basis = some_basis();
  const TemporaryFolder folder;
  const auto back = load_basis(written(folder, [&](StoreWriter& out) { save(out, "basis", basis); }), "basis", 5);
  EXPECT_EQ(back.vectors, basis.vectors);
  EXPECT_EQ(back.mean, basis.mean);
  EXPECT_EQ(back.energy, basis.energy);
  EXPECT_EQ(back.kind, basis.kind);
  EXPECT_EQ(back.provenance, basis.provenance);
}

TEST(Records, BasisOfVectorsAloneIsTaken) {
  const Eigen::MatrixXd vectors = Eigen::MatrixXd::Random(5, 2);
  const TemporaryFolder folder;
  const auto back = load_basis(written(folder, [&](StoreWriter& out) { out.write("basis/vectors", vectors, {}); }));
  EXPECT_EQ(back.vectors, vectors);
  EXPECT_EQ(back.mean, Eigen::VectorXd::Zero(5));
  EXPECT_EQ(back.kind, pod::BasisKind::kUser);
}

TEST(Records, BasisWithNaNOrWrongSizeIsRefused) {
  const TemporaryFolder folder;
  pod::Basis basis = some_basis();
  const auto good = written(folder, [&](StoreWriter& out) { save(out, "basis", basis); });
  expect_parts(message_of([&] { (void)load_basis(good, "basis", 10); }),
               {"record.h5", "basis/vectors", "expected 10 x any, found 5 x 2", "another scene"});
  basis.vectors(4, 1) = kNaN;
  const auto bad = written(folder, [&](StoreWriter& out) { save(out, "basis", basis); });
  expect_parts(message_of([&] { (void)load_basis(bad); }), {"record.h5", "basis/vectors", "NaN", "finite numbers"});
  basis = some_basis();
  basis.vectors = Eigen::MatrixXd::Random(5, 6);
  const auto wide = written(folder, [&](StoreWriter& out) { save(out, "basis", basis); });
  expect_parts(message_of([&] { (void)load_basis(wide); }), {"basis/vectors", "6 modes of 5 dofs"});
}

TEST(Records, PodResultReadsBack) {
  pod::PodResult result;
  result.basis = some_basis();
  result.singular_values = Eigen::VectorXd{{3.0, 2.0, 1e-16}};
  result.shares = Eigen::VectorXd{{0.7, 0.3, 0.0}};
  result.rank = 2;
  const TemporaryFolder folder;
  const auto back = load_pod(written(folder, [&](StoreWriter& out) { save(out, "pod", result); }));
  EXPECT_EQ(back.singular_values, result.singular_values);
  EXPECT_EQ(back.shares, result.shares);
  EXPECT_EQ(back.rank, 2);
  EXPECT_EQ(back.basis.vectors, result.basis.vectors);
}

dynamics::HybridSystem chain_system(fem::ChainOptions options = {.masses = 5, .damping = 0.1}) {
  fem::Structure structure = fem::chain(options);
  const Eigen::Index n = structure.size();
  std::vector<friction::Contact> contacts = {
      {.direction = Eigen::VectorXd::Unit(n, 0), .law = friction::Coulomb{0.4, 0.2}, .normal_load = 2.0, .name = "a"},
      {.direction = Eigen::VectorXd::Unit(n, 2),
       .law = friction::Stribeck{0.5, 0.2, 8.0},
       .normal_load = 3.0,
       .offset = 0.25,
       .name = "b"},
      {.direction = Eigen::VectorXd::Unit(n, 4), .law = friction::TanhRegularised{0.5, 0.2, 1.0, 1e-4}, .name = "c"}};
  return {std::move(structure), std::move(contacts), friction::Belt::ramp(0.1, 0.4, 1.0, 2.0),
          Eigen::VectorXd::LinSpaced(n, -1.0, 1.0)};
}

TEST(Records, ALawMadeOfFunctionsIsRefused) {
  // A file that left it out, or put a description in its place, could not be read back as the system it is of.
  const TemporaryFolder folder;
  const auto chain = chain_system();
  std::vector<friction::Contact> contacts = chain.contacts();
  contacts[0].law =
      friction::Characteristic{.mu_s = 0.4, .mu = [](double) { return 0.3; }, .slope = [](double) { return 0.0; }};
  const dynamics::HybridSystem system(chain.structure(), contacts, chain.drive());
  EXPECT_THAT([&] { (void)written(folder, [&](StoreWriter& out) { save(out, "system", system); }); },
              testing::ThrowsMessage<InvalidInput>(testing::HasSubstr("a file cannot hold")));
}

TEST(Records, SystemReadsBackSparseAndDense) {
  const auto sparse = chain_system();
  expect_same_system(sparse, read_back(sparse));

  const fem::Structure& s = sparse.structure();
  const dynamics::HybridSystem dense({fem::to_dense(s.M()), fem::to_dense(s.C()), fem::to_dense(s.K())},
                                     sparse.contacts(), sparse.drive(), sparse.load());
  const dynamics::HybridSystem back = read_back(dense);
  expect_same_system(dense, back);
  EXPECT_EQ(std::get<friction::TanhRegularised>(back.contacts()[2].law).epsilon, 1e-4);
  EXPECT_EQ(std::get<friction::Stribeck>(back.contacts()[1].law).alpha, 8.0);
}

TEST(Records, DamagedSystemNamesTheFile) {
  const TemporaryFolder folder;
  const auto in = written(folder, [&](StoreWriter& out) {
    out.write("system/units", std::string("SI"), {});
    out.write("system/dof_names", std::vector<std::string>{"x"}, {});
    out.write("system/M", Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, -1.0)), {});  // not positive definite
    out.write("system/C", Eigen::MatrixXd(Eigen::MatrixXd::Zero(1, 1)), {});
    out.write("system/K", Eigen::MatrixXd(Eigen::MatrixXd::Ones(1, 1)), {});
    out.write("system/load", std::vector<double>{}, {});
  });
  expect_parts(message_of([&] { (void)load_system(in); }), {"record.h5", "system", "damaged"});
}

TEST(Records, ReducedModelMustFitItsBasis) {
  const TemporaryFolder folder;
  pod::Basis basis = some_basis();
  basis.vectors = Eigen::MatrixXd::Random(9, 5);
  basis.mean = Eigen::VectorXd::Zero(9);
  basis.energy.resize(0);
  const ReducedModel model{chain_system(), basis};
  const auto back = load_reduced(written(folder, [&](StoreWriter& out) { save(out, "reduced", model); }));
  EXPECT_EQ(back.basis.vectors, basis.vectors);
  expect_same_system(back.system, model.system);
  const auto bad = written(folder, [&](StoreWriter& out) {
    save(out, "reduced", ReducedModel{chain_system(), some_basis()});
  });
  expect_parts(message_of([&] { (void)load_reduced(bad); }), {"reduced", "5 dofs", "2 modes", "inconsistent"});
}

TEST(Provenance, MakesTheSceneAgain) {
  const scene::Scene scene =
      scene::load_scene(SLIPMODE_SOURCE_DIR "/datasets/chain10/scene.toml", {"drive.speed=0.25"});
  Provenance made = provenance_of(scene, "slipmode simulate");
  made.seed = ~0ULL;
  made.audit = dynamics::EnergyAudit{.exchanged = 2.0};
  const TemporaryFolder folder;
  const auto in = written(folder, [&](StoreWriter& out) { save(out, made); });
  const Provenance back = load_provenance(in);
  EXPECT_EQ(back.scene_text, scene.source.text);
  EXPECT_EQ(back.overrides, (std::vector<std::string>{"drive.speed=0.25"}));
  EXPECT_EQ(back.command, "slipmode simulate");
  EXPECT_EQ(back.seed, ~0ULL);
  EXPECT_EQ(back.compiler, compiler());
  ASSERT_TRUE(back.audit.has_value());
  EXPECT_EQ(back.audit->exchanged, 2.0);
  EXPECT_EQ(scene::scene_to_toml(load_scene_of(in)), scene::scene_to_toml(scene));
}

}  // namespace
