#pragma once

#include <slipmode/dynamics/system.hpp>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <complex>
#include <vector>

namespace slipmode::orbits {

/// Degrees of freedom, ascending.
struct Parts {
  std::vector<Eigen::Index> near, rest;
  std::vector<Eigen::Index> boundary;  ///< places among the near ones of those that the rest is coupled to
};
/// @param reach  steps of coupling from a contact that are near it
[[nodiscard]] Parts parts_of(const dynamics::HybridSystem& system, int reach);

/// Highest harmonic of the drive, of an orbit over `order` of its periods, that acts on these; ≥ 1.
[[nodiscard]] int highest_harmonic_on(const dynamics::HybridSystem& system, const std::vector<Eigen::Index>& rest,
                                      int order);

/// A structure parted into what is near its contacts and the rest, which is held to harmonics 0 … H of Ω.
class Partition {
 public:
  /// @param order  periods of the drive in one of Ω
  /// @throws InvalidInput      for a harmonic of the drive beyond H that acts on the rest
  /// @throws NumericalFailure  where the rest has no response at a harmonic
  Partition(const dynamics::HybridSystem& system, int reach, int order, int harmonics);

  [[nodiscard]] const std::vector<Eigen::Index>& near() const { return parts_.near; }
  [[nodiscard]] Eigen::Index coupled() const { return std::ssize(parts_.boundary); }
  [[nodiscard]] Eigen::Index harmonics() const { return harmonics_; }
  /// Real numbers per force: a constant, H cosines, H sines.
  [[nodiscard]] Eigen::Index block() const { return 2 * harmonics_ + 1; }
  [[nodiscard]] double omega() const { return omega_; }
  /// Force directions of the near system before those of the coupling.
  [[nodiscard]] Eigen::Index own_directions() const { return directions_.cols() - coupled(); }
  /// Index of a coupled degree of freedom among the near ones.
  [[nodiscard]] Eigen::Index boundary(Eigen::Index b) const { return parts_.boundary[static_cast<std::size_t>(b)]; }
  /// The near part under these coupling forces, its contacts' forces in this share.
  /// @param coupling  blocks of the coupled degrees of freedom [coupled · block]
  [[nodiscard]] dynamics::HybridSystem system_under(const Eigen::VectorXd& coupling, double share = 1.0) const;

  /// Coupling forces that the rest has without motion of the near part [coupled · block].
  [[nodiscard]] const Eigen::VectorXd& own_coupling() const { return own_coupling_; }
  /// What motions of the coupled degrees of freedom add to that. @param motion  columns [coupled · block x k]
  [[nodiscard]] Eigen::MatrixXd coupling_by(const Eigen::MatrixXd& motion) const;

  /// Phasors of the rest [n_R x H+1]. @param motion  of the coupled degrees of freedom [coupled · block]
  [[nodiscard]] Eigen::MatrixXcd rest_under(const Eigen::VectorXd& motion) const;
  /// The linear response of the whole without contacts: state of the near part at time 0, and coupling forces.
  struct Response {
    dynamics::State near;
    Eigen::VectorXd coupling;
  };
  [[nodiscard]] Response without_contacts() const;

 private:
  using SparseComplex = Eigen::SparseMatrix<std::complex<double>>;

  void make_near_part();
  /// (K + ikΩC − k²Ω²M)(rows, columns)
  [[nodiscard]] SparseComplex stiffness(int k, const std::vector<Eigen::Index>& rows,
                                        const std::vector<Eigen::Index>& columns) const;
  /// Phasor of the loads on these degrees of freedom at order k.
  [[nodiscard]] Eigen::VectorXcd loads(int k, const std::vector<Eigen::Index>& rows) const;

  dynamics::HybridSystem system_;
  int order_;
  Eigen::Index harmonics_;
  double omega_;
  fem::SparseMatrix M_, C_, K_;
  Parts parts_;
  std::vector<friction::Contact> contacts_;  ///< of the near part
  Eigen::MatrixXd directions_;               ///< of forces on it
  Eigen::MatrixXd near_M_, near_C_, near_K_;
  Eigen::VectorXd near_load_;
  std::vector<Eigen::MatrixXcd> impedance_;  ///< S_k = D_1R D_RR⁻¹ D_R1 at the coupled degrees of freedom
  Eigen::VectorXd own_coupling_;
};

/// Phasor of order k of a block of real coefficients, and back.
[[nodiscard]] std::complex<double> phasor(const Eigen::VectorXd& blocks, Eigen::Index b, Eigen::Index harmonics,
                                          Eigen::Index k);
void put_phasor(std::complex<double> value, Eigen::Index b, Eigen::Index harmonics, Eigen::Index k,
                Eigen::VectorXd& out_blocks);

}  // namespace slipmode::orbits
