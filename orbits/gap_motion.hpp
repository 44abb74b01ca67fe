#pragma once

#include <slipmode/dynamics/system.hpp>

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

namespace slipmode::orbits {

/// Steady motion of the structure under its force drive with no contact force, at time 0: S0's start in the centre of
/// the gap. Where the structure floats its place is that of minimum norm.
/// @throws InvalidInput  for a drive that is no force, or a frequency at which the structure resonates undamped
[[nodiscard]] dynamics::State linear_response(const dynamics::HybridSystem& system);

/// Motion between the stops of all clearances, linear and in closed form: the steady response and
///
///     x − x_s = Σ_k c_k v_k e^{λ_k t},     G v = λ v,     G = [0 1; −M⁻¹K −M⁻¹C].
///
/// Parts with Re λ = 0 last: shifts of a structure that floats, free vibrations of one without damping. Then the steady
/// motions in the gap are a continuum. States are (q; q̇) at the drive's phase of time 0 [2n].
/// Derivation: docs/theory/basins.md, section 2.
class GapMotion {
 public:
  /// Nothing where there is no such motion in closed form: a contact that is no clearance, a drive that is no force,
  /// resonance or drift without damping.
  [[nodiscard]] static std::optional<GapMotion> of(const dynamics::HybridSystem& system);

  /// Distances to stops, each proved from below; the smallest and the next [m].
  struct Room {
    double least, next;
  };
  /// What the motion from x keeps for ever, if positive; else nothing is proved.
  [[nodiscard]] Room room(const Eigen::VectorXd& x) const { return room_of(parts_of(x), false); }
  /// The same for what lasts of it, the stops passed through on the way: the steady motion it ends in fits in the gap
  /// if positive. Source: for one mass it is S2 (15), |x + v/(2ξ)| < e − a/(ω√(4ξ² + ω²)).
  [[nodiscard]] Room room_at_end(const Eigen::VectorXd& x) const { return room_of(parts_of(x), true); }
  /// How far the steady response goes to one side, at the clearance where it goes farthest [m].
  [[nodiscard]] double reach() const { return reach_.maxCoeff(); }

  /// What may last beside the steady response.
  enum class Continuum : std::uint8_t {
    kNone,   ///< nothing: one steady motion
    kShift,  ///< a place: its coordinate is the mean displacement of the first clearance [m]
    kFree,   ///< free vibrations: their amplitude at the first clearance [m]
  };
  [[nodiscard]] Continuum continuum() const { return continuum_; }
  /// Which one of the continuum the motion ends in [m]; 0 for kNone.
  [[nodiscard]] double coordinate(const Eigen::VectorXd& x) const;
  /// The steady motion with nothing beside it, shifted to where the stops leave most room.
  [[nodiscard]] const Eigen::VectorXd& middle() const { return middle_; }

 private:
  /// A stop seen from the gap: side (y − gap) < 0.
  struct Side {
    Eigen::Index clearance;
    double side, gap;
  };
  [[nodiscard]] Eigen::VectorXcd parts_of(const Eigen::VectorXd& x) const;
  [[nodiscard]] Room room_of(const Eigen::VectorXcd& parts, bool at_end) const;
  void set_middle();

  Eigen::VectorXd steady_;     ///< x_s at time 0 [2n]
  Eigen::VectorXd mean_;       ///< of each clearance's steady displacement [nc]
  Eigen::MatrixXd reach_;      ///< its largest and −smallest, proved from above [nc x 2]
  Eigen::VectorXcd rates_;     ///< λ [2n], 0 for shifts
  Eigen::MatrixXcd vectors_;   ///< v, columns [2n x 2n]
  Eigen::MatrixXcd to_parts_;  ///< their inverse
  Eigen::MatrixXcd seen_;      ///< displacement of the clearances in each part [nc x 2n]
  std::vector<Side> sides_;
  Continuum continuum_ = Continuum::kNone;
  double tiny_ = 0.0;  ///< rates below this are zero [1/s]
  Eigen::VectorXd middle_;
};

}  // namespace slipmode::orbits
