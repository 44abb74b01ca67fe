#pragma once

#include <slipmode/results/records.hpp>
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <bit>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <vector>

/// Records written to a file and read from it, and systems compared to the last bit.
namespace slipmode::tests {

/// Writes into a new file and hands out a reader of it.
inline results::StoreReader written(const TemporaryFolder& folder,
                                    const std::function<void(results::StoreWriter&)>& write) {
  results::StoreWriter out(folder.path() / "record.h5", results::FileKind::kTrajectory);
  write(out);
  out.commit();
  return results::StoreReader(folder.path() / "record.h5");
}

inline dynamics::HybridSystem read_back(const dynamics::HybridSystem& system) {
  const TemporaryFolder folder;
  return load_system(written(folder, [&](results::StoreWriter& out) { save(out, "system", system); }));
}

/// The numbers of a contact, law, load and all but stops, as bits: equal also where they are NaN or −0.
inline std::vector<std::uint64_t> bits_of(const friction::Contact& contact) {
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
  if (const auto* law = std::get_if<friction::Stribeck>(&contact.law)) add({law->mu_s, law->mu_k, law->alpha});
  if (const auto* law = std::get_if<friction::TanhRegularised>(&contact.law)) {
    add({law->mu_s, law->mu_k, law->alpha, law->epsilon});
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

inline void expect_same_structure(const fem::Structure& a, const fem::Structure& b) {
  EXPECT_EQ(fem::to_dense(a.M()), fem::to_dense(b.M()));
  EXPECT_EQ(fem::to_dense(a.C()), fem::to_dense(b.C()));
  EXPECT_EQ(fem::to_dense(a.K()), fem::to_dense(b.K()));
  EXPECT_EQ(a.M().index(), b.M().index());  // sparse stays sparse
  EXPECT_EQ(a.C().index(), b.C().index());
  EXPECT_EQ(a.K().index(), b.K().index());
  EXPECT_EQ(a.rayleigh().has_value(), b.rayleigh().has_value());
  EXPECT_EQ(a.has_symmetric_damping(), b.has_symmetric_damping());
  EXPECT_EQ(a.dof_names(), b.dof_names());
  EXPECT_EQ(a.units(), b.units());
}

inline void expect_same_drive(const friction::Drive& a, const friction::Drive& b) {
  ASSERT_EQ(a.belt() != nullptr, b.belt() != nullptr);
  ASSERT_EQ(a.shaker() != nullptr, b.shaker() != nullptr);
  ASSERT_EQ(a.force() != nullptr, b.force() != nullptr);
  if (const friction::Belt* belt = a.belt()) {
    EXPECT_EQ(belt->speed, b.belt()->speed);
    EXPECT_EQ(belt->end_speed, b.belt()->end_speed);
    EXPECT_EQ(belt->ramp_begin, b.belt()->ramp_begin);
    EXPECT_EQ(belt->ramp_end, b.belt()->ramp_end);
  }
  if (const friction::Shaker* shaker = a.shaker()) {
    EXPECT_EQ(shaker->amplitude, b.shaker()->amplitude);
    EXPECT_EQ(shaker->frequency_hz, b.shaker()->frequency_hz);
    EXPECT_EQ(shaker->phase, b.shaker()->phase);
  }
  if (const friction::Force* force = a.force()) {
    EXPECT_EQ(force->omega, b.force()->omega);
    ASSERT_EQ(force->harmonics.size(), b.force()->harmonics.size());
    for (std::size_t k = 0; k < force->harmonics.size(); ++k) {
      const friction::ForceHarmonic &one = force->harmonics[k], &other = b.force()->harmonics[k];
      EXPECT_EQ(one.amplitude, other.amplitude);
      EXPECT_EQ(one.phase, other.phase);
      EXPECT_EQ(one.order, other.order);
      EXPECT_EQ(one.direction, other.direction);
    }
  }
}

inline void expect_same_contact(const friction::Contact& a, const friction::Contact& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(bits_of(a), bits_of(b));
  ASSERT_EQ(a.law.index(), b.law.index());
  if (const auto* law = std::get_if<friction::Clearance>(&a.law)) {
    const auto& other = std::get<friction::Clearance>(b.law);
    EXPECT_EQ(law->loss, other.loss);
    EXPECT_EQ(law->left, other.left);
    EXPECT_EQ(law->right, other.right);
  }
}

inline void expect_same_system(const dynamics::HybridSystem& a, const dynamics::HybridSystem& b) {
  expect_same_structure(a.structure(), b.structure());
  EXPECT_EQ(a.load(), b.load());
  EXPECT_EQ(a.force_directions(), b.force_directions());
  expect_same_drive(a.drive(), b.drive());
  ASSERT_EQ(a.contacts().size(), b.contacts().size());
  for (std::size_t c = 0; c < a.contacts().size(); ++c) expect_same_contact(a.contacts()[c], b.contacts()[c]);
}

}  // namespace slipmode::tests
