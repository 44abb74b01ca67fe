#pragma once

// Other contact laws and normal loads for a scene's contacts.

#include <slipmode/scene/scene.hpp>

#include <optional>
#include <string>
#include <vector>

namespace slipmode::trade {

/// A scene with other contacts, and what changed in words.
struct OtherContacts {
  std::string name;
  scene::Scene scene;
};

/// The scene with every contact changed that `change` takes; empty when it takes none.
/// @param change  changes the contact and says whether it did
template <class Change>
std::optional<scene::Scene> with_contacts(const scene::Scene& scene, const Change& change) {
  scene::Scene other = scene;
  bool any = false;
  for (scene::ContactSpec& contact : other.contacts) any = change(contact) || any;
  return any ? std::optional(std::move(other)) : std::nullopt;
}

/// The scene with every law replaced for which `other` gives another one; empty when it gives none.
/// @param other  friction::Law → std::optional<friction::Law>
template <class Other>
std::optional<scene::Scene> with_laws(const scene::Scene& scene, const Other& other) {
  return with_contacts(scene, [&other](scene::ContactSpec& contact) {
    const auto law = other(contact.law);
    if (law) contact.law = *law;
    return law.has_value();
  });
}

/// True when a flow can run the scene; some laws go with no tilt or no varying load.
[[nodiscard]] bool can_run(const scene::Scene& scene);

/// Contacts without springs and bristles: Coulomb's law or Stribeck's for regularised and bristle laws.
[[nodiscard]] std::optional<scene::Scene> with_rigid_contacts(const scene::Scene& scene);
/// Contact springs of a multiple of their stiffness; on a rigid Coulomb contact of a multiple of the structure's own
/// stiffness there, (wᵀKw)/(wᵀw)².
[[nodiscard]] std::optional<scene::Scene> with_springs(const scene::Scene& scene, double factor);
/// The tanh law with ε in units of the drive's speed. A static coefficient that Coulomb's law has only at rest is given
/// to sliding speeds up to about 10 ε.
[[nodiscard]] std::optional<scene::Scene> with_tanh(const scene::Scene& scene, double share);

[[nodiscard]] std::vector<OtherContacts> other_laws(const scene::Scene& scene);
[[nodiscard]] std::vector<OtherContacts> other_loads(const scene::Scene& scene);

/// Normal loads that are constant, and without their own vibration.
[[nodiscard]] std::optional<scene::Scene> with_constant_load(const scene::Scene& scene);
[[nodiscard]] std::optional<scene::Scene> without_normal_vibration(const scene::Scene& scene);

}  // namespace slipmode::trade
