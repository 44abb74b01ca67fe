#include "selftest/scene_rates.hpp"

#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/modal_model.hpp>

#include <algorithm>
#include <cmath>

namespace slipmode::selftest {
namespace {

using Eigen::Index;

/// A bound on the force of a contact: friction's limit, or what a stop that is met at this speed, or pressed from the
/// start, answers with [N].
double largest_force(const friction::Contact& contact, const dynamics::State& start, double mobility, double speed) {
  double most = friction::contact_forces(contact).most();
  if (const friction::Clearance* clearance = friction::clearance(contact.law))
    for (const friction::Stop& stop : clearance->stops())
      most = std::max(most, stop.stiffness * std::abs(contact.direction.dot(start.q)) +
                                speed * (std::sqrt(stop.stiffness / mobility) + stop.damping));
  return most;
}

/// Bounds on the accelerations of contacts without their own forces: by motion, by what drives, by the other contacts
/// [m/s²].
Eigen::VectorXd accelerations(const dynamics::HybridSystem& system, const dynamics::ModalModel& model,
                              const dynamics::State& start, double speed) {
  const friction::Drive& drive = system.drive();
  double counterpart = 0.0;
  if (const auto* belt = drive.belt()) counterpart = std::abs(belt->acceleration(belt->ramp_begin));
  if (const auto* shaker = drive.shaker()) counterpart = shaker->amplitude * shaker->omega() * shaker->omega();
  Eigen::VectorXd bound = Eigen::VectorXd::Constant(model.contacts, speed * model.fastest + counterpart) +
                          model.load_acceleration.cwiseAbs();
  if (const auto* force = drive.force())
    for (const auto& harmonic : force->harmonics)
      bound += harmonic.amplitude * model.force_acceleration.col(harmonic.direction).cwiseAbs();
  for (Index d = 0; d < bound.size(); ++d) {
    const friction::Contact& other = system.contacts()[static_cast<std::size_t>(d)];
    const double limit = largest_force(other, start, model.mobility(d, d), speed);
    for (Index c = 0; c < bound.size(); ++c)
      if (c != d) bound(c) += limit * std::abs(model.mobility(c, d));
  }
  return bound;
}

}  // namespace

double fastest_rate(const dynamics::HybridSystem& system, const dynamics::State& start) {
  const dynamics::ModalModel& model = system.cache().tables(system, false).model;
  double rate = std::max(model.fastest, kSlowest);
  const double speed =
      start.v.cwiseAbs().maxCoeff() + start.q.cwiseAbs().maxCoeff() * rate + system.drive().velocity_scale(0.0);
  const Eigen::VectorXd acceleration = accelerations(system, model, start, speed);
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    const friction::Contact& contact = system.contacts()[c];
    const auto at = static_cast<Index>(c);
    const double mobility = model.mobility(at, at), load = contact.normal_load.constant;
    rate += friction::fastest_rate(
        contact.law, {.load = load, .mobility = mobility, .speed = speed, .acceleration = acceleration(at)});
    rate += std::sqrt(std::abs(contact.normal_load.slope) * mobility);
    if (const auto& own = contact.normal_load.oscillator)
      rate += std::sqrt((own->support_stiffness + own->spring_stiffness) / own->mass);
  }
  if (const auto* shaker = system.drive().shaker()) rate = std::max(rate, shaker->omega());
  if (const auto* force = system.drive().force()) {
    for (const auto& harmonic : force->harmonics) rate = std::max(rate, harmonic.order * force->omega);
  }
  return rate;
}

}  // namespace slipmode::selftest
