#include <slipmode/dynamics/system.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/friction/places.hpp>
#include "dynamics/internal/drive_cache.hpp"

#include <algorithm>
#include <string>

namespace slipmode::dynamics {
namespace {

void check_drive(const friction::Drive& drive, Eigen::Index directions) {
  friction::validate(drive);
  if (const friction::Force* force = drive.force())
    for (const friction::ForceHarmonic& h : force->harmonics)
      if (h.direction >= directions)
        throw InvalidInput("a harmonic of the force acts along direction " + std::to_string(h.direction) +
                           " (from 0), but the system has " + std::to_string(directions) + " force directions");
}

Eigen::Index rank_of(const std::vector<Eigen::VectorXd>& directions) {
  if (directions.empty()) return 0;
  Eigen::MatrixXd W(directions.front().size(), std::ssize(directions));
  for (std::size_t c = 0; c < directions.size(); ++c) W.col(static_cast<Eigen::Index>(c)) = directions[c];
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(W);
  qr.setThreshold(1e-12);
  return qr.rank();
}

/// Contacts that may not share a place are independent: those that stick rigidly of one another, and each of the others
/// of these.
void check_independence(const std::vector<friction::Contact>& contacts) {
  using friction::LawKind;
  std::vector<Eigen::VectorXd> rigid;
  const auto check = [](const std::vector<Eigen::VectorXd>& apart) {
    if (const Eigen::Index rank = rank_of(apart); rank < std::ssize(apart))
      throw InvalidInput(
          "the directions of " + std::to_string(apart.size()) +
          " contacts that stick rigidly, or have a spring or bristles beside such, are linearly dependent "
          "(rank " +
          std::to_string(rank) +
          "): two contacts act on the same degree of freedom, contacts close a ring, or a reduced basis has fewer "
          "vectors than contacts; merge them, put those of a ring behind springs (law \"compliant\"), or keep more "
          "modes");
  };
  for (const friction::Contact& contact : contacts)
    if (friction::sticks_rigidly(friction::kind(contact.law))) rigid.push_back(contact.direction.normalized());
  check(rigid);
  for (const friction::Contact& contact : contacts) {
    const LawKind kind = friction::kind(contact.law);
    if (rigid.empty() || friction::sticks_rigidly(kind) || friction::can_share_place(LawKind::kConstant, kind))
      continue;
    std::vector<Eigen::VectorXd> apart = rigid;
    apart.push_back(contact.direction.normalized());
    check(apart);
  }
}

}  // namespace

HybridSystem::HybridSystem(fem::Structure structure, std::vector<friction::Contact> contacts, friction::Drive drive,
                           Eigen::VectorXd load, Eigen::MatrixXd force_directions)
    : structure_(std::move(structure)),
      contacts_(std::move(contacts)),
      drive_(std::move(drive)),
      load_(std::move(load)),
      force_directions_(std::move(force_directions)),
      cache_(std::make_shared<SystemCache>()),
      drive_cache_(std::make_shared<DriveCache>()) {
  const auto n = structure_.size();
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (contacts_[c].direction.size() != n)
      throw InvalidInput("contact " + std::to_string(c + 1) + ": direction has " +
                         std::to_string(contacts_[c].direction.size()) + " entries, the structure has " +
                         std::to_string(n) + " degrees of freedom");
    friction::validate(contacts_[c]);
  }
  check_independence(contacts_);
  if (force_directions_.cols() == 0) force_directions_.resize(n, 0);
  if (force_directions_.rows() != n || !force_directions_.allFinite())
    throw InvalidInput("force directions have " + std::to_string(force_directions_.rows()) +
                       " rows or values that are not finite; " + std::to_string(n) + " finite values are expected");
  check_drive(drive_, force_directions_.cols());
  if (load_.size() > 0 && (load_.size() != n || !load_.allFinite()))
    throw InvalidInput("constant load has " + std::to_string(load_.size()) +
                       " entries or values that are not finite; " + std::to_string(n) + " finite values are expected");
}

HybridSystem HybridSystem::with_drive(friction::Drive drive) const {
  check_drive(drive, force_directions_.cols());
  HybridSystem copy = *this;
  copy.drive_ = std::move(drive);
  copy.drive_cache_ = std::make_shared<DriveCache>();
  return copy;
}

HybridSystem HybridSystem::with_laws(std::vector<friction::Contact> contacts) const {
  if (!std::ranges::equal(contacts, contacts_, friction::same_place))
    throw InvalidInput("other laws: expected the same contacts in the same places, found others");
  for (const friction::Contact& contact : contacts) friction::validate(contact);
  check_independence(contacts);
  HybridSystem copy = *this;
  copy.contacts_ = std::move(contacts);
  copy.cache_ = std::make_shared<SystemCache>(cache_->models());
  copy.drive_cache_ = std::make_shared<DriveCache>();
  return copy;
}

Eigen::Index HybridSystem::internal_begin(int c) const {
  Eigen::Index begin = 0;
  for (int d = 0; d < c; ++d) begin += friction::internal_states(contacts_[static_cast<std::size_t>(d)]);
  return begin;
}

Eigen::Index HybridSystem::internal_size() const { return internal_begin(static_cast<int>(contacts_.size())); }

State HybridSystem::rest() const { return {0.0, Eigen::VectorXd::Zero(size()), Eigen::VectorXd::Zero(size()), {}, {}}; }

double HybridSystem::energy(const State& state) const {
  const double energy = structure_.energy(state.q, state.v);
  return load_.size() > 0 ? energy - load_.dot(state.q) : energy;
}

double stick_share(const HybridSystem& system, std::span<const double> stick_time, double time) {
  double stuck = 0.0, able = 0.0;
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    if (!friction::sticks(friction::kind(system.contacts()[c].law))) continue;
    stuck += stick_time[c];
    able += 1.0;
  }
  return able > 0.0 ? stuck / (able * time) : 0.0;
}

const ModelTables& ModelCache::tables(const HybridSystem& system, bool rows_only) {
  const bool rows = rows_only && system.structure().rayleigh() && system.structure().is_chain_like();
  const std::lock_guard lock(building_);
  auto& slot = rows ? rows_ : full_;
  if (!slot) slot = std::make_unique<ModelTables>(build_modal_model(system, rows));
  return *slot;
}

const RegimeTables& SystemCache::regime(const HybridSystem& system, const std::vector<ContactRole>& roles) {
  const ModelTables& full = tables(system, false);
  const std::lock_guard lock(building_);
  auto& slot = regimes_[roles];
  if (!slot) slot = std::make_unique<RegimeTables>(system, full.model, roles);
  return *slot;
}

}  // namespace slipmode::dynamics
