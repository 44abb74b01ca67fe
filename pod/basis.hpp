#pragma once

#include "fem/structure.hpp"

#include <Eigen/Core>
#include <string>

namespace slipmode::pod {

enum class BasisKind { kPom, kLnm, kUser };

/// An affine basis q ≈ mean + Φ a.
struct Basis {
  Eigen::MatrixXd vectors;  ///< Φ, n x L. POMs are orthonormal (ΦᵀΦ = I), LNMs mass-orthonormal (ΦᵀMΦ = I)
  Eigen::VectorXd mean;     ///< q̄ [n]; zero for LNMs
  Eigen::VectorXd energy;   ///< share of each kept vector in the ensemble's energy [L]; empty if unknown
  BasisKind kind = BasisKind::kUser;
  std::string provenance;  ///< how it was made, in words

  [[nodiscard]] Eigen::Index modes() const { return vectors.cols(); }
  /// The same basis cut to its first L vectors. @throws InvalidInput if L < 1 or L > modes()
  [[nodiscard]] Basis truncated(Eigen::Index L) const;
};

/// How many modes to keep: a count, or the smallest number whose cumulative energy share reaches `energy`.
struct ModeChoice {
  Eigen::Index modes = 0;  ///< 0: by energy
  double energy = 0.99;    ///< in (0, 1]; S4 section 3.4.2 uses 0.99
};

}  // namespace slipmode::pod
