#include <slipmode/diagnostics/exponents/phase_volume.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include "diagnostics/exponents/internal/energy_metric.hpp"

#include <algorithm>
#include <cmath>

namespace slipmode::diagnostics {
namespace {

using dynamics::ContactMode;
using friction::ContactForces;
using friction::LawKind;

bool is_stop(ContactMode mode) { return mode == ContactMode::kLeftStop || mode == ContactMode::kRightStop; }

double stop_damping(const ContactForces& law, ContactMode mode) {
  if (!is_stop(mode)) return 0.0;
  return mode == ContactMode::kLeftStop ? law.clearance.left->damping : law.clearance.right->damping;
}

/// Simpson's rule over equally spaced values, an odd number of them.
double simpson(const Eigen::VectorXd& values, double step, Eigen::Index stride) {
  double sum = 0.0;
  const Eigen::Index last = values.size() - 1;
  for (Eigen::Index i = 0; i <= last; i += stride) {
    const bool end = i == 0 || i == last;
    sum += values[i] * (end ? 1.0 : (i / stride) % 2 == 1 ? 4.0 : 2.0);
  }
  return sum * step * static_cast<double>(stride) / 3.0;
}

}  // namespace

PhaseVolume::PhaseVolume(const dynamics::HybridSystem& system)
    : system_(system),
      damping_(fem::to_dense(system.structure().C())),
      stiffness_(fem::to_dense(system.structure().K())),
      fastest_(EnergyMetric(system).fastest()) {
  for (const friction::Contact& contact : system.contacts()) laws_.push_back(friction::contact_forces(contact));
  const Eigen::LLT<Eigen::MatrixXd> mass(fem::to_dense(system.structure().M()));
  inverse_mass_ = mass.solve(Eigen::MatrixXd::Identity(system.size(), system.size()));
}

bool PhaseVolume::applies(const dynamics::HybridSystem& system) {
  return system.internal_size() == 0 && std::ranges::all_of(system.contacts(), [](const friction::Contact& contact) {
           return friction::clearance(contact.law) != nullptr || contact.normal_load.is_constant();
         });
}

Eigen::MatrixXd PhaseVolume::held(const std::vector<ContactMode>& modes) const {
  Eigen::MatrixXd W(system_.size(), std::ranges::count(modes, ContactMode::kStick));
  Eigen::Index k = 0;
  for (std::size_t c = 0; c < modes.size(); ++c)
    if (modes[c] == ContactMode::kStick) W.col(k++) = system_.contacts()[c].direction;
  return W;
}

Eigen::MatrixXd PhaseVolume::mobility_of(const std::vector<ContactMode>& modes) const {
  const Eigen::MatrixXd W = held(modes);
  if (W.cols() == 0) return inverse_mass_;
  const Eigen::MatrixXd MW = inverse_mass_ * W;
  const Eigen::MatrixXd gram = W.transpose() * MW;
  return inverse_mass_ - MW * gram.ldlt().solve(MW.transpose());
}

double PhaseVolume::slope(int contact, double relative_velocity) const {
  return -laws_[static_cast<std::size_t>(contact)].slope(std::copysign(1.0, relative_velocity), relative_velocity);
}

PhaseContraction PhaseVolume::along(const dynamics::State& start, double duration,
                                    const dynamics::FlowOptions& flow) const {
  constexpr double kStep = 0.2, kAgreement = 1e-7;
  constexpr int kHalvings = 12;
  const Eigen::MatrixXd mobility = mobility_of(start.modes);
  PhaseContraction out{.viscous = -duration * mobility.cwiseProduct(damping_.transpose()).sum()};
  std::vector<std::pair<int, double>> sliding;  // contact, its own mobility
  for (int c = 0; c < static_cast<int>(laws_.size()); ++c) {
    const ContactForces& law = laws_[static_cast<std::size_t>(c)];
    const ContactMode mode = start.modes[static_cast<std::size_t>(c)];
    const Eigen::VectorXd& w = system_.contacts()[static_cast<std::size_t>(c)].direction;
    const double own = w.dot(mobility * w);
    out.viscous -= duration * own * stop_damping(law, mode);
    const bool depends = law.kind == LawKind::kSpeedDependent || law.kind == LawKind::kSmooth;
    if (depends && mode != ContactMode::kStick) sliding.emplace_back(c, own);
  }
  if (sliding.empty() || !(duration > 0.0)) return out;

  auto panels = 4 * static_cast<Eigen::Index>(std::ceil(duration * fastest_ / (4.0 * kStep)));
  for (int halving = 0; halving <= kHalvings; ++halving, panels *= 2) {
    const double step = duration / static_cast<double>(panels);
    // A little less than the step, so that the last sample is not lost to rounding of the times.
    const dynamics::SimulateOptions run{.duration = duration,
                                        .sample = step * (1.0 - 1e-12),
                                        .keep_events = false,
                                        .output = dynamics::SimulateOptions::Output::kContacts,
                                        .flow = flow};
    const dynamics::Trajectory motion = dynamics::simulate(system_, start, run);
    double fine = 0.0, coarse = 0.0;
    for (const auto& [c, own] : sliding) {
      Eigen::VectorXd values(panels + 1);
      for (Eigen::Index i = 0; i <= panels; ++i) {
        const double relative = system_.drive().velocity(motion.times[i]) - motion.contact_v(c, i);
        values[i] = own * slope(c, relative);
      }
      fine += simpson(values, step, 1);
      coarse += simpson(values, step, 2);
    }
    out.friction = fine;
    if (std::abs(fine - coarse) <= kAgreement * std::max(std::abs(fine), duration * fastest_ * 1e-3)) break;
  }
  return out;
}

Eigen::VectorXd PhaseVolume::normal(const std::vector<ContactMode>& modes, int contact) const {
  const Eigen::VectorXd& w = system_.contacts()[static_cast<std::size_t>(contact)].direction;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(2 * system_.size());
  const Eigen::VectorXd impulse = mobility_of(modes) * w;
  out.tail(system_.size()) = impulse / std::sqrt(w.dot(impulse));
  return out;
}

double PhaseVolume::relative_acceleration(const dynamics::State& at, const std::vector<ContactMode>& modes,
                                          int contact) const {
  const friction::Drive& drive = system_.drive();
  Eigen::VectorXd force = -(damping_ * at.v) - stiffness_ * at.q;
  if (system_.load().size() > 0) force += system_.load();
  if (const friction::Force* pushed = drive.force())
    for (Eigen::Index k = 0; k < system_.force_directions().cols(); ++k)
      force += pushed->value(static_cast<int>(k), at.time) * system_.force_directions().col(k);
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    if (modes[c] == ContactMode::kStick) continue;
    const friction::Contact& other = system_.contacts()[c];
    const double v = other.direction.dot(at.v);
    const double lambda =
        laws_[c].kind == LawKind::kClearance
            ? laws_[c].clearance.force(dynamics::stop_side(modes[c]), other.direction.dot(at.q) + other.offset, v)
            : laws_[c].sliding(dynamics::sign_of(modes[c]), drive.velocity(at.time) - v);
    force += lambda * other.direction;
  }
  const Eigen::VectorXd& w = system_.contacts()[static_cast<std::size_t>(contact)].direction;
  // Stuck contacts hold their own acceleration at the drive's; what that costs this contact is part of the answer.
  const Eigen::MatrixXd mobility = mobility_of(modes);
  double acceleration = w.dot(mobility * force);
  if (const Eigen::MatrixXd W = held(modes); W.cols() > 0) {
    const Eigen::MatrixXd MW = inverse_mass_ * W;
    const Eigen::MatrixXd gram = W.transpose() * MW;
    acceleration +=
        (w.transpose() * MW * gram.ldlt().solve(Eigen::VectorXd::Ones(W.cols())))(0) * drive.acceleration(at.time);
  }
  return drive.acceleration(at.time) - acceleration;
}

double PhaseVolume::reversal(const dynamics::State& at, int contact, ContactMode before) const {
  std::vector<ContactMode> modes = at.modes;
  const double after = relative_acceleration(at, modes, contact);
  modes[static_cast<std::size_t>(contact)] = before;
  return std::log(std::abs(after / relative_acceleration(at, modes, contact)));
}

}  // namespace slipmode::diagnostics
