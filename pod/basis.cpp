#include <slipmode/pod/basis.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::pod {

std::string_view to_string(BasisKind kind) {
  switch (kind) {
    case BasisKind::kPom:
      return "pom";
    case BasisKind::kLnm:
      return "lnm";
    case BasisKind::kPomf:
      return "pomf";
    case BasisKind::kLnmStatic:
      return "lnm+static";
    case BasisKind::kMassPom:
      return "mass-pom";
    case BasisKind::kUser:
      break;
  }
  return "user";
}

Basis Basis::truncated(Eigen::Index L) const {
  if (L < 1 || L > modes()) {
    throw InvalidInput(
        fmt::format("basis: cannot keep {} modes of a basis of {}; expected 1 to {}", L, modes(), modes()));
  }
  Basis cut = *this;
  cut.vectors = vectors.leftCols(L);
  if (energy.size() > L) cut.energy = energy.head(L).eval();
  return cut;
}

Eigen::VectorXd cumulative(const Eigen::VectorXd& shares) {
  Eigen::VectorXd sum = shares;
  for (Eigen::Index i = 1; i < sum.size(); ++i) sum[i] += sum[i - 1];
  return sum;
}

Eigen::Index modes_for_share(const Eigen::VectorXd& captured, double share) {
  return std::min(captured.size(),
                  std::ranges::find_if(captured, [&](double own) { return own >= share; }) - captured.begin() + 1);
}

Eigen::Index chosen_modes(const ModeChoice& choice, const Eigen::VectorXd& captured, Eigen::Index available,
                          const std::string& source) {
  if (choice.modes > available) {
    throw InvalidInput(fmt::format("modes = {}: {} holds only {}; valid: 1 to {}, set by --modes or reduction.modes",
                                   choice.modes, source, available, available));
  }
  if (choice.modes > 0) return choice.modes;
  return captured.size() == 0 ? available : std::min(available, modes_for_share(captured, choice.energy));
}

}  // namespace slipmode::pod
