#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/fem/structure.hpp>

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <tuple>

namespace slipmode::pod {

enum class BasisKind {
  kPom,        ///< proper orthogonal modes of snapshots (pod.hpp, mass_pod.hpp)
  kLnm,        ///< linear natural modes of the slipping structure
  kUser,       ///< supplied
  kPomf,       ///< proper orthogonal modal functions: sensor POMs made continuous (pomf.hpp)
  kLnmStatic,  ///< one static mode per contact, then linear natural modes (rom/reduce.hpp)
};

/// "pom", "lnm", "user", "pomf" or "lnm_static": the word for files and tables.
[[nodiscard]] std::string_view to_string(BasisKind kind);

/// An affine basis q ≈ mean + Φ a.
struct Basis {
  Eigen::MatrixXd vectors;  ///< Φ, n x L. POMs of pod() have ΦᵀΦ = I; those of mass_pod() and the others ΦᵀMΦ = I
  Eigen::VectorXd mean;     ///< q̄ [n]; zero for LNMs
  /// Share of each kept vector in the ensemble's energy [L]; empty if unknown. For a POMF that of the POM it came from.
  Eigen::VectorXd energy;
  BasisKind kind = BasisKind::kUser;
  std::string provenance;  ///< how it was made, in words

  [[nodiscard]] Eigen::Index modes() const { return vectors.cols(); }
  /// The same basis cut to its first L vectors. @throws InvalidInput if L < 1 or L > modes()
  [[nodiscard]] Basis truncated(Eigen::Index L) const;
};

/// How many modes to keep: a count, or the smallest number whose cumulative energy share reaches `energy`.
struct ModeChoice {
  Eigen::Index modes = 0;  ///< 0: by energy
  double energy = 0.99;    ///< S4 section 3.4.2 uses 0.99

  static constexpr auto fields() {
    return std::tuple{optional("modes", &ModeChoice::modes, "", "how many", kCount),
                      optional("energy", &ModeChoice::energy, "1", "cumulative share to be reached",
                               {.low = 0.0, .high = 1.0, .above = true, .text = "a share > 0 and <= 1"})};
  }
};

}  // namespace slipmode::pod
