#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/fem/structure.hpp>

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <tuple>

namespace slipmode::pod {

enum class BasisKind {
  kPom,        ///< proper orthogonal modes of snapshots (pod())
  kLnm,        ///< linear natural modes of the slipping structure
  kUser,       ///< supplied
  kPomf,       ///< proper orthogonal modal functions: sensor POMs made continuous (pomf.hpp)
  kLnmStatic,  ///< one static mode per contact, then linear natural modes (rom/reduce.hpp)
  kMassPom,    ///< proper orthogonal modes of snapshots in the mass metric (mass_pod())
};

/// "pom", "lnm", "user", "pomf", "lnm+static" or "mass-pom": the word for files and tables.
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

/// A basis to be judged or chosen from, with as many vectors as shall be tried: its first L are the model of L modes.
struct NamedBasis {
  std::string name;  ///< "POM", "LNM"; of a shaken scene's words "pomf", "lnm", "lnm+static", "mass-pom"
  Basis basis;
  Eigen::VectorXd captured = {};  ///< element L − 1: share of the ensemble's energy in the first L; empty: not known
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

/// The smallest number of modes whose cumulative share reaches `share`; where none does, as many as there are shares.
[[nodiscard]] Eigen::Index modes_for_share(const Eigen::VectorXd& captured, double share);

/// The number of modes a choice asks for, given the shares of energy captured (NamedBasis::captured).
/// @param source  what the modes come from, for the message
/// @throws InvalidInput  when more modes are asked than there are
[[nodiscard]] Eigen::Index chosen_modes(const ModeChoice& choice, const Eigen::VectorXd& captured,
                                        Eigen::Index available, const std::string& source);

/// Element i: the sum of the first i + 1.
[[nodiscard]] Eigen::VectorXd cumulative(const Eigen::VectorXd& shares);

}  // namespace slipmode::pod
