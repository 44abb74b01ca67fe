#pragma once

#include <slipmode/diagnostics/attractors/driven_sweep.hpp>
#include <slipmode/diagnostics/model.hpp>
#include <slipmode/orbits/branches/continuation.hpp>
#include <slipmode/pod/basis.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/scene/scene.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::studies {

/// A scene's model, full or projected on a basis, at values of some of its keys: what every study that varies a
/// parameter works on.
///
/// What a value leaves as it is, is shared: under keys of the drive all modal data and regimes, under numbers of a
/// contact's law or load the modal data. Copies are cheap and share it all; safe to use from several threads.
class Family {
 public:
  /// @param keys   "drive.speed", "contact.0.mu_s", …; none: the scene as it stands
  /// @param basis  of the reduced model; empty: the full model
  /// @throws InvalidInput  as scene::build_system and rom::reduce
  explicit Family(scene::Scene scene, std::vector<std::string> keys = {}, std::optional<pod::NamedBasis> basis = {});

  /// The model at one value per key, in the order of the keys.
  /// @throws InvalidInput  for another number of values than keys, or a value that the scene refuses (frequencies and
  ///                       amplitudes of a drive are not checked against the scene)
  [[nodiscard]] dynamics::HybridSystem at(const std::vector<double>& values) const { return case_at(values).system; }
  /// The same with what is read from a shaken one and what its lifted states add to the energy.
  [[nodiscard]] diagnostics::DrivenCase case_at(const std::vector<double>& values) const;

  /// The model at the scene's own values.
  [[nodiscard]] const dynamics::HybridSystem& own() const;
  /// Where the scene lets it start, in the model's coordinates.
  [[nodiscard]] dynamics::State start() const;
  /// A state of the full model as this model has it: unchanged, or the nearest of the basis (rom::restrict_state).
  [[nodiscard]] dynamics::State own_state(const dynamics::State& full) const;
  /// "full model, 10 degrees of freedom"; "reduced model, 6 modes", with the basis' name where it has one.
  [[nodiscard]] std::string title() const;
  [[nodiscard]] const scene::Scene& scene() const;
  [[nodiscard]] const std::vector<std::string>& keys() const;
  /// Set for a reduced model.
  [[nodiscard]] const std::optional<pod::NamedBasis>& basis() const;
  /// Key, label and unit of one key. @param k  which
  [[nodiscard]] results::SweepAxis axis(std::size_t k = 0) const;

  /// As solvers take a family over one key.
  [[nodiscard]] diagnostics::Model model() const;
  [[nodiscard]] diagnostics::DrivenModel driven_model() const;
  [[nodiscard]] dynamics::SystemFamily systems() const;

 private:
  struct Shared;
  std::shared_ptr<const Shared> shared_;
};

/// Every value is tried before the first is computed: a typing error must not show after an hour.
/// @throws InvalidInput  for a value the scene refuses or that changes the number of degrees of freedom
void check_values(const scene::Scene& scene, const std::string& key, const std::vector<double>& values);

}  // namespace slipmode::studies
