#pragma once

#include <slipmode/dynamics/consistency.hpp>
#include <slipmode/dynamics/regime.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/friction/load_form.hpp>
#include "dynamics/internal/pair_form.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace slipmode::dynamics {

/// Builds what a regime holds of the structure: its pairs, inputs, outputs and changes of coordinates.
///
/// Everything is formed in the undamped modes η of the slipping structure (M = 1, K = diag ω²): in the physical degrees
/// of freedom of a fine mesh the low frequencies would lose as many digits as the highest has over the lowest, squared.
class RegimeBuilder {
 public:
  RegimeBuilder(const HybridSystem& system, const ModalModel& slipping, const std::vector<ContactRole>& roles);

  void fill(Regime& out);
  /// Once the motion that follows the inputs is known.
  void make_steady_forces(Regime& out) const;

 private:
  /// y (what is left of η), ẏ, ζ, ζ̇ from x, and back.
  struct Coordinates {
    Eigen::MatrixXd to_y, to_rate, to_zeta, to_zeta_rate;
    Eigen::MatrixXd from_y, from_rate, from_zeta, from_zeta_rate;
  };

  void eliminate_held();
  /// Zᵀ of columns. A held contact does not move: what the projection leaves of it, or of what acts on it alone, is
  /// rounding, which scaled up would couple, or be the only stiffness of what floats.
  [[nodiscard]] Eigen::MatrixXd left_of(const Eigen::MatrixXd& directions) const;
  void couple_contacts();
  /// Of y.
  [[nodiscard]] Eigen::MatrixXd left_damping() const;
  /// Undamped modes of what is held and of springs that are positive.
  [[nodiscard]] fem::Modes base_modes() const;
  void make_pairs(Regime& out);
  void reuse_slipping_pairs(Regime& out);
  void make_symmetric_pairs(Regime& out);
  void make_general_pairs(Regime& out);
  /// Where contacts add springs and dampers to modes that are damped each by itself.
  [[nodiscard]] std::optional<PairForm> supported_pairs() const;
  /// @param shapes  η = shapes · (modes of the balanced state); null: they are η
  void set_pairs(Regime& out, const PairForm& form, const Eigen::VectorXd& scale, const Eigen::MatrixXd* shapes);
  void set_blocks(ModalModel& pairs, const PairForm& form) const;
  void make_inputs(Regime& out) const;
  void make_contact_rows(Regime& out) const;
  /// Contacts of one direction that are told apart by their stretches alone.
  struct Places {
    std::vector<Eigen::Index> first;
    std::vector<std::vector<Eigen::Index>> together;
    std::vector<double> stiffness;  ///< of all springs there [N/m]
  };
  [[nodiscard]] Places places(const std::function<bool(Eigen::Index)>& counts) const;
  /// Puts what is known better of contacts together into these entries of their columns, by their stiffnesses, where it
  /// is near what they have, to a share of `size`. @param better  [places x entries] @param size  [places]
  void improve(const Places& at, const std::vector<Eigen::Index>& entries, const Eigen::MatrixXd& better,
               const Eigen::VectorXd& size, double near, Eigen::MatrixXd& of_contacts) const;
  /// Contacts that stick: held, or by their springs.
  [[nodiscard]] Places holding_places(const Regime& out) const;
  /// Springs of which the slipping modes' equations tell more than their stretches.
  [[nodiscard]] Places refinable_springs(const Regime& out) const;
  /// States of the slipping structure's undamped modes (η, η̇), in columns: what forces along these directions add to
  /// their rates; their rates without any force, G_s s; G_sᵀ of columns.
  [[nodiscard]] Eigen::MatrixXd of_forces(const Eigen::MatrixXd& along) const;
  [[nodiscard]] Eigen::MatrixXd mode_rates(const Eigen::MatrixXd& states) const;
  [[nodiscard]] Eigen::MatrixXd of_mode_rates(const Eigen::MatrixXd& columns) const;
  /// What their equations round by of a pair's two coordinates, each at its own rate [2n x 2].
  /// @param at_rate, beside  of the pair's columns (or rows) in modes: what moves of each is the largest entry of the
  ///                         one times that rate and of the other [n x 2]
  [[nodiscard]] Eigen::MatrixXd mode_errors(const Eigen::Matrix2d& G, const Eigen::MatrixXd& at_rate,
                                            const Eigen::MatrixXd& beside) const;
  /// Of contacts that stick, without the cancellation behind a stiff spring or on a fine mesh.
  void refine_stick_rows(Regime& out) const;
  /// The same of what a spring that the drive pulls does to the pairs.
  void refine_spring_inputs(Regime& out) const;
  void make_outputs(Regime& out) const;
  using AddOutput = std::function<void(Eigen::Index, RegimeOutput::Kind, Eigen::VectorXd, Eigen::VectorXd)>;
  void add_clearance_outputs(Eigen::Index c, const Regime& out, const AddOutput& add) const;
  void make_changes(Regime& out) const;

  [[nodiscard]] ContactRole role(Eigen::Index c) const { return roles_[static_cast<std::size_t>(c)]; }
  [[nodiscard]] const ContactForces& law(Eigen::Index c) const { return laws_[static_cast<std::size_t>(c)]; }
  /// The stop that presses, or would in flight; null for any other contact.
  [[nodiscard]] const friction::Stop* stop(Eigen::Index c) const;
  [[nodiscard]] const friction::LoadForm& load(Eigen::Index c) const { return loads_[static_cast<std::size_t>(c)]; }

  const ModalModel& slipping_;
  const ModalCoordinates& modal_;
  const std::vector<ContactRole>& roles_;
  std::optional<fem::Rayleigh> rayleigh_;
  std::vector<std::vector<std::size_t>> along_;  ///< contacts along one direction
  std::vector<ContactForces> laws_;
  std::vector<friction::LoadForm> loads_;
  std::vector<ContactAnswer> answers_;
  Eigen::Index n_, nc_, nk_, ni_, V_, one_;
  std::vector<Eigen::Index> held_, oscillators_;  ///< contacts
  Eigen::VectorXd friction_;                      ///< ±μ_k of contacts that slide under a varying load, else 0
  Eigen::VectorXd most_damped_;                   ///< Σ_j |D_ij|, what damps mode i [n]
  Eigen::MatrixXd Z_, P_;                         ///< η = Z y + P ι
  Eigen::VectorXd P_all_;
  Eigen::MatrixXd moved_;         ///< contacts' directions in y, zero where held ones leave none [m x contacts]
  Eigen::MatrixXd KP_, KP_size_;  ///< K P, K with what contacts add, and the sizes it is a sum of [n x inputs]
  Eigen::MatrixXd C_;             ///< with what contacts add
  Eigen::VectorXd spring_;        ///< stiffness added along each contact's direction, of either sign
  Eigen::VectorXd damper_;        ///< damping that stops add along it
  bool symmetric_ = true, bare_ = true;
  Coordinates at_;
  Eigen::MatrixXd to_modes_;  ///< x → (η, η̇), beside what the inputs hold [2n x 2np]
};

}  // namespace slipmode::dynamics
