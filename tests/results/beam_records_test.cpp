// Stored models of shaken beams: every law, load and drive, full and reduced, to the last bit.

#include <slipmode/results/records.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/scene.hpp>
#include "scene/beam_scene.hpp"
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

namespace {

using namespace slipmode;
using namespace slipmode::results;
using tests::TemporaryFolder;

/// Writes into a new file and hands out a reader of it.
StoreReader stored(const TemporaryFolder& folder, const std::function<void(StoreWriter&)>& write) {
  StoreWriter out(folder.path() / "record.h5", FileKind::kTrajectory);
  write(out);
  out.commit();
  return StoreReader(folder.path() / "record.h5");
}

/// The numbers of a contact, law, load and all, as bits: equal also where they are NaN or −0.
std::vector<std::uint64_t> bits_of(const friction::Contact& contact) {
  std::vector<double> v(contact.direction.begin(), contact.direction.end());
  const auto add = [&v](std::initializer_list<double> more) { v.insert(v.end(), more); };
  add({contact.normal_load.constant, contact.normal_load.slope, contact.offset, contact.tilt});
  if (const auto& own = contact.normal_load.oscillator) {
    add({own->mass, own->support_stiffness, own->support_damping, own->spring_stiffness, own->spring_damping,
         own->slope});
  }
  if (const auto* law = std::get_if<friction::Coulomb>(&contact.law)) add({law->mu_s, law->mu_k});
  if (const auto* law = std::get_if<friction::CompliantCoulomb>(&contact.law)) {
    add({law->mu_s, law->mu_k, law->stiffness});
  }
  if (const auto* law = std::get_if<friction::Dahl>(&contact.law)) add({law->mu, law->stiffness});
  if (const auto* law = std::get_if<friction::LuGre>(&contact.law)) {
    add({law->mu_s, law->mu_k, law->stribeck_speed, law->stiffness, law->damping, law->viscous});
  }
  if (const auto* law = std::get_if<friction::Measured>(&contact.law)) {
    add({law->mu_s});
    v.insert(v.end(), law->speeds.begin(), law->speeds.end());
    v.insert(v.end(), law->coefficients.begin(), law->coefficients.end());
  }
  std::vector<std::uint64_t> bits;
  for (const double value : v) bits.push_back(std::bit_cast<std::uint64_t>(value));
  return bits;
}

void expect_same(const dynamics::HybridSystem& a, const dynamics::HybridSystem& b) {
  EXPECT_EQ(fem::to_dense(a.structure().M()), fem::to_dense(b.structure().M()));
  EXPECT_EQ(fem::to_dense(a.structure().C()), fem::to_dense(b.structure().C()));
  EXPECT_EQ(fem::to_dense(a.structure().K()), fem::to_dense(b.structure().K()));
  EXPECT_EQ(a.structure().M().index(), b.structure().M().index());
  EXPECT_EQ(a.structure().C().index(), b.structure().C().index());
  EXPECT_EQ(a.structure().rayleigh().has_value(), b.structure().rayleigh().has_value());
  EXPECT_EQ(a.structure().dof_names(), b.structure().dof_names());
  EXPECT_EQ(a.structure().units(), b.structure().units());
  EXPECT_EQ(a.load(), b.load());
  ASSERT_EQ(a.drive().shaker() != nullptr, b.drive().shaker() != nullptr);
  if (const friction::Shaker* shaker = a.drive().shaker()) {
    EXPECT_EQ(shaker->amplitude, b.drive().shaker()->amplitude);
    EXPECT_EQ(shaker->frequency_hz, b.drive().shaker()->frequency_hz);
    EXPECT_EQ(shaker->phase, b.drive().shaker()->phase);
  }
  ASSERT_EQ(a.contacts().size(), b.contacts().size());
  for (std::size_t c = 0; c < a.contacts().size(); ++c) {
    EXPECT_EQ(a.contacts()[c].law.index(), b.contacts()[c].law.index());
    EXPECT_EQ(bits_of(a.contacts()[c]), bits_of(b.contacts()[c]));
    EXPECT_EQ(a.contacts()[c].name, b.contacts()[c].name);
  }
}

dynamics::HybridSystem back(const dynamics::HybridSystem& system) {
  const TemporaryFolder folder;
  return load_system(stored(folder, [&](StoreWriter& out) { save(out, "system", system); }));
}

TEST(BeamRecords, SystemReadsBackWithEveryDamping) {
  for (const char* damping : {"modal_ratio = 0.01", "coefficient = 1e-5\nmass_coefficient = 0.3",
                              "ratio = 0.01\nfrequency = 3", "ratio = [0.01, 0.02]\nfrequency = [3, 50]"}) {
    SCOPED_TRACE(damping);
    const auto system =
        scene::build_system(scene::parse_scene(tests::replaced(tests::kBeamScene, "modal_ratio = 0.01", damping)));
    expect_same(system, back(system));
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
  expect_same(system, back(system));
}

TEST(BeamRecords, ReducedBeamReadsBackToTheSameBits) {
  const auto full = scene::build_system(scene::parse_scene(tests::kBeamScene));
  const pod::Basis basis = rom::lnm_static_basis(full, 3);
  const ReducedModel model{rom::reduce(full, basis), basis};
  const TemporaryFolder folder;
  const auto read = load_reduced(stored(folder, [&](StoreWriter& out) { save(out, "reduced", model); }));
  expect_same(model.system, read.system);
  EXPECT_EQ(read.basis.vectors, basis.vectors);
  EXPECT_EQ(read.basis.kind, pod::BasisKind::kLnmStatic);
}

TEST(BeamRecords, ModalFunctionsKeepTheirKind) {
  pod::Basis basis;
  basis.vectors = Eigen::MatrixXd::Identity(4, 2);
  basis.kind = pod::BasisKind::kPomf;
  const TemporaryFolder folder;
  const auto in = stored(folder, [&](StoreWriter& out) { save(out, "basis", basis); });
  EXPECT_EQ(load_basis(in).kind, pod::BasisKind::kPomf);
}

// Files of earlier versions say lnm_static where scenes say lnm+static.
TEST(BeamRecords, StaticModesOfEarlierFilesAreKnown) {
  const TemporaryFolder folder;
  const auto in = stored(folder, [&](StoreWriter& out) {
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
  const auto read = load_state(stored(folder, [&](StoreWriter& out) { save(out, "state", state); }), "state");
  EXPECT_EQ(read.internal, state.internal);
  EXPECT_EQ(read.modes, state.modes);
}

TEST(BeamRecords, FilesOfEarlierVersionsAreStillRead) {
  // A rigid contact on a belt as the first version stored it: no stiffness, tilt, slope, oscillator, internal states.
  const TemporaryFolder folder;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  const auto in = stored(folder, [&](StoreWriter& out) {
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
