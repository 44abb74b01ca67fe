#pragma once

#include <slipmode/dynamics/system.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/results/shaken_modes.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>
#include <slipmode/trade/variant.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::studies {

/// Sensors → displacements → POMs → modal functions → POMFs, as [sensors] and [reduction] say, and mass POMs.
/// @param snapshots  all degrees of freedom
[[nodiscard]] results::ShakenModes shaken_modes(const scene::Scene& scene, const fem::Structure& structure,
                                                const pod::Ensemble& snapshots);

/// How many vectors a choice takes of a basis: by energy no fewer than the scene has contacts, as these have to move
/// each on its own. Otherwise as pod::chosen_modes.
[[nodiscard]] Eigen::Index chosen_modes(const scene::Scene& scene, const pod::ModeChoice& choice,
                                        const Eigen::VectorXd& captured, Eigen::Index available,
                                        const std::string& source);

/// The basis that a word of a shaken scene means, with all vectors that can be used.
/// @param motion  bases from motion need an ensemble's modes: called when such a word comes
/// @throws InvalidInput  for "pomf" without sensors, or "pom" on a beam
[[nodiscard]] pod::Basis shaken_basis(scene::BasisChoice word, const scene::Scene& scene,
                                      const dynamics::HybridSystem& system,
                                      const std::function<const results::ShakenModes&()>& motion);

/// The bases that a scene's reduced models are compared in: under a shaker those of validation.bases; elsewhere POMs
/// and LNMs about the ensemble's mean, the kind that [reduction] names first; under a force also LNMs with a static
/// mode per contact, unless the structure floats or has as many contacts as degrees of freedom.
[[nodiscard]] std::vector<pod::NamedBasis> shaken_bases(const scene::Scene& scene, const dynamics::HybridSystem& system,
                                                        const std::function<const results::ShakenModes&()>& motion);
[[nodiscard]] std::vector<pod::NamedBasis> plain_bases(const scene::Scene& scene, const dynamics::HybridSystem& system,
                                                       const pod::PodResult& result);

/// The bases a result file gives to be compared: the one of a reduced model; those above of a POD, or of an ensemble's
/// or trajectory's snapshots.
/// @throws InvalidInput  when it holds none of them, or is of another size
[[nodiscard]] std::vector<pod::NamedBasis> load_bases(const scene::Scene& scene, const dynamics::HybridSystem& full,
                                                      const results::StoreReader& store);

/// The same, each cut to so many modes and named so ("6 POMs").
/// @param modes  0: all of a reduced model's, else as [reduction] chooses
/// @throws InvalidInput  also for more modes than there are, or where nothing says how many
[[nodiscard]] std::vector<pod::NamedBasis> load_chosen_bases(const scene::Scene& scene,
                                                             const dynamics::HybridSystem& full,
                                                             const results::StoreReader& store, Eigen::Index modes);

/// The one basis that a scene's model is to be projected on. `captured` is empty where no energies are known.
/// Natural modes are about the mean of the motion that a POD is of, else about diagnostics::resting_place.
/// @param source  "lnm", under a shaker also "lnm+static", or a result file with a POD (of its bases the one that
///                [reduction] names), a basis or a reduced model
/// @throws InvalidInput  when the file holds no basis, or one for another number of degrees of freedom
[[nodiscard]] pod::NamedBasis load_basis(const scene::Scene& scene, const dynamics::HybridSystem& full,
                                         const std::string& source);
[[nodiscard]] pod::NamedBasis load_basis(const scene::Scene& scene, const dynamics::HybridSystem& full,
                                         const results::StoreReader& store);

/// The basis of a model named "full" (none), "rom:FILE", or under a shaker "BASIS:L", made as the scene's ensemble
/// says.
/// @throws InvalidInput  for another name, a file without a basis for the scene, more modes than there are
[[nodiscard]] std::optional<pod::NamedBasis> model_basis(const scene::Scene& scene, const std::string& model,
                                                         const RunOptions& run);

/// The bases that `trade` tries, each with the processor time that making it took. Natural modes alone where the
/// ensemble gives no modes (it does not move), none for one degree of freedom.
[[nodiscard]] std::vector<trade::OfferedBasis> offered_bases(const scene::Scene& scene, const RunOptions& run);

}  // namespace slipmode::studies
