#include <slipmode/studies/family.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/driven.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <functional>
#include <numbers>
#include <utility>

namespace slipmode::studies {
namespace {

using diagnostics::DrivenCase;
using friction::Drive;

/// A drive with one of its numbers changed.
using DriveSetter = std::function<Drive(const Drive& drive, double value)>;

/// For the keys of a drive that need no reading of the scene anew; else empty. The amplitude of a shaker follows its
/// curve over frequency, so its frequency alone can be set.
DriveSetter drive_setter(const scene::Scene& scene, const std::string& key, bool alone) {
  if (key == "drive.speed" && scene.drive.is_constant()) {
    return [](const Drive&, double speed) { return Drive(friction::Belt::constant(speed)); };
  }
  if (scene.drive.shaker() != nullptr && key == "drive.frequency" && alone) {
    return [scene](const Drive&, double frequency) { return scene::drive_at(scene, frequency); };
  }
  if (scene.drive.force() == nullptr) return nullptr;
  if (key == "drive.omega" || key == "drive.frequency") {
    const double factor = key == "drive.omega" ? 1.0 : 2.0 * std::numbers::pi;
    return [factor](const Drive& drive, double value) {
      return Drive(friction::Force{factor * value, drive.force()->harmonics});
    };
  }
  if (key != "drive.amplitude") return nullptr;
  return [](const Drive& drive, double amplitude) {
    friction::Force changed = *drive.force();
    changed.harmonics.front().amplitude = amplitude;
    return Drive(changed);
  };
}

/// Where a force acts, and its mean, belong to the structure; its numbers, and all of a belt or shaker, to the drive.
bool is_of_drive(const scene::Scene& scene, const std::string& key) {
  if (!key.starts_with("drive.")) return false;
  if (scene.drive.force() == nullptr) return true;
  const std::string number = key.substr(key.rfind('.') + 1);
  const bool own = key == "drive." + number, harmonic = key.starts_with("drive.harmonic.");
  return (own || harmonic) && (number == "omega" || number == "frequency" || number == "amplitude" ||
                               number == "phase" || number == "order");
}

/// A contact's place decides what the structure's modes show of it, all else of [[contact]] is its law's.
bool is_of_law(const std::string& key) {
  return key.starts_with("contact.") && !key.ends_with(".at") && key.find(".between") == std::string::npos;
}

DrivenCase full_case(const scene::Scene& scene) {
  if (is_driven(scene)) return scene::driven_case(scene);
  DrivenCase belt{.system = scene::build_system(scene), .readings = {}};
  belt.readings.rows.resize(0, belt.system.size());  // none, and projected there are none
  return belt;
}

DrivenCase projected(const DrivenCase& full, const std::optional<pod::NamedBasis>& basis) {
  return basis ? diagnostics::reduced_case(full, basis->basis) : full;
}

}  // namespace

struct Family::Shared {
  scene::Scene scene;
  std::vector<std::string> keys;
  std::optional<pod::NamedBasis> basis;
  DrivenCase own;
  bool drive_only = false, laws_only = false;
  std::vector<DriveSetter> setters;  ///< one per key, or none where the scene must be read anew

  [[nodiscard]] scene::Scene scene_at(const std::vector<double>& values) const {
    scene::Scene changed = scene;
    for (std::size_t k = 0; k < keys.size(); ++k) changed = scene::set_key(changed, keys[k], values[k]);
    return changed;
  }
  [[nodiscard]] Drive drive_at(const std::vector<double>& values) const {
    if (setters.empty()) return scene_at(values).drive;
    Drive drive = scene.drive;
    for (std::size_t k = 0; k < keys.size(); ++k) drive = setters[k](drive, values[k]);
    return drive;
  }
};

Family::Family(scene::Scene scene, std::vector<std::string> keys, std::optional<pod::NamedBasis> basis) {
  DrivenCase own = projected(full_case(scene), basis);
  Shared shared{.scene = std::move(scene),
                .keys = std::move(keys),
                .basis = std::move(basis),
                .own = std::move(own),
                .drive_only = false,
                .laws_only = false,
                .setters = {}};
  shared.drive_only =
      std::ranges::all_of(shared.keys, [&](const std::string& key) { return is_of_drive(shared.scene, key); });
  shared.laws_only = std::ranges::all_of(shared.keys, is_of_law);
  for (const std::string& key : shared.keys) {
    shared.setters.push_back(drive_setter(shared.scene, key, shared.keys.size() == 1));
  }
  if (!std::ranges::all_of(shared.setters, [](const DriveSetter& setter) { return setter != nullptr; })) {
    shared.setters.clear();
  }
  shared_ = std::make_shared<const Shared>(std::move(shared));
}

DrivenCase Family::case_at(const std::vector<double>& values) const {
  if (values.size() != shared_->keys.size()) {
    throw InvalidInput(
        fmt::format("family over {} keys: expected as many values, found {}", shared_->keys.size(), values.size()));
  }
  if (values.empty()) return shared_->own;
  const DrivenCase& own = shared_->own;
  const auto with = [&own](dynamics::HybridSystem system) {
    return DrivenCase{.system = std::move(system), .readings = own.readings, .energy_offset = own.energy_offset};
  };
  if (shared_->drive_only) return with(own.system.with_drive(shared_->drive_at(values)));
  const scene::Scene changed = shared_->scene_at(values);
  if (shared_->laws_only) return with(scene::with_laws_of(changed, own.system));
  return projected(full_case(changed), shared_->basis);
}

const dynamics::HybridSystem& Family::own() const { return shared_->own.system; }

const scene::Scene& Family::scene() const { return shared_->scene; }

const std::vector<std::string>& Family::keys() const { return shared_->keys; }

const std::optional<pod::NamedBasis>& Family::basis() const { return shared_->basis; }

dynamics::State Family::start() const {
  return own_state(scene::initial_state(shared_->scene, scene::build_system(shared_->scene)));
}

dynamics::State Family::own_state(const dynamics::State& full) const {
  if (!shared_->basis) return full;
  return rom::restrict_state(scene::build_system(shared_->scene).structure(), shared_->basis->basis, full);
}

std::string Family::title() const {
  if (!shared_->basis) return fmt::format("full model, {} degrees of freedom", own().size());
  const std::string& name = shared_->basis->name;
  return fmt::format("reduced model, {} modes{}", own().size(), name.empty() ? "" : fmt::format(" ({})", name));
}

results::SweepAxis Family::axis(std::size_t k) const {
  return results::sweep_axis(shared_->scene, shared_->keys.at(k));
}

diagnostics::Model Family::model() const {
  diagnostics::Model model{.system = systems()};
  if (!basis()) return model;
  model.basis = basis()->basis;
  model.energy_offset = [family = *this](double value) { return family.case_at({value}).energy_offset; };
  return model;
}

diagnostics::DrivenModel Family::driven_model() const {
  return [family = *this](double value) { return family.case_at({value}); };
}

dynamics::SystemFamily Family::systems() const {
  return [family = *this](double value) { return family.at({value}); };
}

void check_values(const scene::Scene& scene, const std::string& key, const std::vector<double>& values) {
  for (const double value : values) {
    const Eigen::Index size = scene::set_key(scene, key, value).size();
    if (size == scene.size()) continue;
    throw InvalidInput(
        fmt::format("over {}: the number of degrees of freedom must stay at {} along a sweep, value {} changes it; "
                    "run one sweep per size",
                    key, scene.size(), value));
  }
}

}  // namespace slipmode::studies
