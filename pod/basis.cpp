#include <slipmode/pod/basis.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

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
      return "lnm_static";
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

}  // namespace slipmode::pod
