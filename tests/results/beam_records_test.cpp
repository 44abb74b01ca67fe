// Stored models of shaken beams: every law, load and drive, full and reduced, to the last bit.

#include <slipmode/results/records.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/scene.hpp>
#include "results/stored_systems.hpp"
#include "scene/beam_scene.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <cstdint>
#include <vector>

namespace {

using namespace slipmode;
using namespace slipmode::results;
using tests::expect_same_system;
using tests::read_back;
using tests::TemporaryFolder;
using tests::written;

TEST(BeamRecords, SystemReadsBackWithEveryDamping) {
  for (const char* damping : {"modal_ratio = 0.01", "coefficient = 1e-5\nmass_coefficient = 0.3",
                              "ratio = 0.01\nfrequency = 3", "ratio = [0.01, 0.02]\nfrequency = [3, 50]"}) {
    SCOPED_TRACE(damping);
    const auto system =
        scene::build_system(scene::parse_scene(tests::replaced(tests::kBeamScene, "modal_ratio = 0.01", damping)));
    expect_same_system(system, read_back(system));
  }
}

TEST(BeamRecords, SystemReadsBackWithEveryLawAndLoad) {
  const fem::Beam beam = scene::build_beam(scene::parse_scene(tests::kBeamScene));
  const auto at = [&beam](double x) { return beam.displacement_row(x); };
  friction::NormalOscillator oscillator{0.02, 90.0, 0.1, 282.8, 1.0 / 3.0, -5e-3};
  std::vector<friction::Contact> contacts = {
      {.direction = at(0.1), .law = friction::Coulomb{0.5, 0.4}, .normal_load = {0.3, -1.54}, .name = "rigid"},
      {.direction = at(0.2), .law = friction::Dahl{1.0 / 3.0, 1e4}, .normal_load = 0.7, .name = "dahl"},
      {.direction = at(0.3), .law = friction::LuGre{0.5, 0.4, 0.1, 1e4, 0.2, 0.3}, .offset = 1e-3, .name = "lugre"},
      {.direction = at(0.33),
       .law = friction::Measured{0.5, {0.0, 0.1 / 3.0, 0.7}, {0.5, 0.3, 0.1 / 3.0}},
       .name = "points"},
      {.direction = at(0.36), .law = friction::Measured{0.4, {0.0, 1.0}, {0.3, 0.6}}, .name = "rising"},
      {.direction = at(0.4),
       .law = friction::CompliantCoulomb{0.748, 0.55, 20e3},
       .normal_load = {0.345, oscillator},
       .tilt = 0.1 / 3.0,
       .name = "compliant"}};
  const dynamics::HybridSystem system(beam.structure(), contacts, friction::Shaker{1e-3 / 3.0, 12.1, 0.7});
  expect_same_system(system, read_back(system));
}

TEST(BeamRecords, ReducedBeamReadsBackToTheSameBits) {
  const auto full = scene::build_system(scene::parse_scene(tests::kBeamScene));
  const pod::Basis basis = rom::lnm_static_basis(full, 3);
  const ReducedModel model{rom::reduce(full, basis), basis};
  const TemporaryFolder folder;
  const auto read = load_reduced(written(folder, [&](StoreWriter& out) { save(out, "reduced", model); }));
  expect_same_system(model.system, read.system);
  EXPECT_EQ(read.basis.vectors, basis.vectors);
  EXPECT_EQ(read.basis.kind, pod::BasisKind::kLnmStatic);
}

TEST(BeamRecords, ModalFunctionsKeepTheirKind) {
  pod::Basis basis;
  basis.vectors = Eigen::MatrixXd::Identity(4, 2);
  basis.kind = pod::BasisKind::kPomf;
  const TemporaryFolder folder;
  const auto in = written(folder, [&](StoreWriter& out) { save(out, "basis", basis); });
  EXPECT_EQ(load_basis(in).kind, pod::BasisKind::kPomf);
}

// Files of earlier versions say lnm_static where scenes say lnm+static.
TEST(BeamRecords, StaticModesOfEarlierFilesAreKnown) {
  const TemporaryFolder folder;
  const auto in = written(folder, [&](StoreWriter& out) {
    out.write("basis/vectors", Eigen::MatrixXd(Eigen::MatrixXd::Identity(4, 2)), {"1", ""});
    out.write("basis/kind", std::string("lnm_static"), {"", ""});
  });
  EXPECT_EQ(load_basis(in).kind, pod::BasisKind::kLnmStatic);
}

TEST(BeamRecords, StateKeepsContactsOwnStates) {
  const dynamics::State state{1.5,
                              Eigen::VectorXd::Random(4),
                              Eigen::VectorXd::Random(4),
                              {dynamics::ContactMode::kSeparated, dynamics::ContactMode::kStick},
                              Eigen::VectorXd{{1e-5, 2e-3, -0.1 / 3.0, 0.0}}};
  const TemporaryFolder folder;
  const auto read = load_state(written(folder, [&](StoreWriter& out) { save(out, "state", state); }), "state");
  EXPECT_EQ(read.internal, state.internal);
  EXPECT_EQ(read.modes, state.modes);
}

TEST(BeamRecords, FilesOfEarlierVersionsAreStillRead) {
  // A rigid contact on a belt as the first version stored it: no stiffness, tilt, slope, oscillator, internal states.
  const TemporaryFolder folder;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  const auto in = written(folder, [&](StoreWriter& out) {
    const auto number = [&out](const std::string& name, double value) {
      out.write("system/contacts/" + name, std::vector<double>{value}, {});
    };
    out.write("system/units", std::string("SI"), {});
    out.write("system/dof_names", std::vector<std::string>{"x"}, {});
    for (const char* matrix : {"M", "C", "K"}) out.write(std::string("system/") + matrix, one, {});
    out.write("system/load", std::vector<double>{}, {});
    out.write("system/contacts/name", std::vector<std::string>{"a"}, {});
    out.write("system/contacts/law", std::vector<std::string>{"coulomb"}, {});
    number("mu_s", 0.5);
    number("mu_k", 0.4);
    number("alpha", std::nan(""));
    number("epsilon", std::nan(""));
    number("normal_load", 2.0);
    number("offset", 0.25);
    out.write_columns("system/contacts/direction", one, {});
    out.write("system/drive/kind", std::string("belt"), {});
    for (const char* key : {"speed", "end_speed", "ramp_begin", "ramp_end"}) {
      out.write(std::string("system/drive/") + key, 0.0, {});
    }
    out.write("state/time", 1.0, {});
    out.write("state/q", Eigen::VectorXd(Eigen::VectorXd::Ones(1)), {});
    out.write("state/v", Eigen::VectorXd(Eigen::VectorXd::Ones(1)), {});
    out.write("state/modes", std::vector<std::int64_t>{0}, {});
  });
  const dynamics::HybridSystem system = load_system(in);
  EXPECT_EQ(std::get<friction::Coulomb>(system.contacts()[0].law).mu_k, 0.4);
  EXPECT_TRUE(system.contacts()[0].normal_load.is_constant());
  EXPECT_EQ(system.contacts()[0].tilt, 0.0);
  EXPECT_EQ(load_state(in, "state").internal.size(), 0);
}

}  // namespace
