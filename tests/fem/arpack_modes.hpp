#pragma once

// The Lanczos of another library, to check the project's own against.

#include <slipmode/fem/modes.hpp>
#include "fem/internal/eigensolvers.hpp"
#include "fem/internal/mode_conventions.hpp"
#include "fem/internal/shift_invert.hpp"

#include <arpack/arpack.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace slipmode::fem {

namespace arpack {

inline constexpr double kRoundingUnit = 0.0;  // ARPACK reads this as the machine's rounding unit

// The arrays that dsaupd fills and dseupd reads.
struct Workspace {
  Workspace(int n, int count)
      : subspace(std::min(n, 2 * count + 20)),
        residual(n),
        lanczos(n, subspace),
        vectors(3 * n),
        small(subspace * (subspace + 8)) {
    // A fixed start: ARPACK's own random one depends on earlier calls. The golden ratio spreads it over all modes.
    for (int i = 0; i < n; ++i) residual(i) = 1.0 + std::fmod(0.6180339887498949 * (i + 1), 1.0);
    settings[0] = 1;  // exact shifts
    settings[2] = detail::kMaxRestarts;
    settings[6] = 3;  // generalized problem, shift-invert
  }

  int subspace;
  Eigen::VectorXd residual;
  Eigen::MatrixXd lanczos;
  Eigen::VectorXd vectors;
  Eigen::VectorXd small;
  std::array<int, 11> settings{};
  std::array<int, 14> offsets{};
};

inline void iterate(const detail::ShiftInvert& inverse, int n, int count, Workspace& work) {
  const auto segment = [&work, n](int offset) { return work.vectors.segment(work.offsets[offset] - 1, n); };
  int request = 0;
  int info = 1;  // start from work.residual
  for (;;) {
    dsaupd_c(&request, "G", n, "LM", count, kRoundingUnit, work.residual.data(), work.subspace, work.lanczos.data(), n,
             work.settings.data(), work.offsets.data(), work.vectors.data(), work.small.data(),
             static_cast<int>(work.small.size()), &info);
    if (request == -1) {
      segment(1) = inverse.solve(inverse.mass() * segment(0));
    } else if (request == 1) {
      segment(1) = inverse.solve(segment(2));  // ARPACK has M x already
    } else if (request == 2) {
      segment(1) = inverse.mass() * segment(0);
    } else {
      break;
    }
  }
  if (info != 0) throw std::runtime_error("ARPACK's dsaupd ended with info = " + std::to_string(info));
}

}  // namespace arpack

/// The lowest `count_wanted` < n natural modes by ARPACK's shift-invert Lanczos, with the conventions of Modes. ARPACK
/// keeps state between its calls: never run two at once.
inline Modes arpack_modes(const Structure& structure, Eigen::Index count_wanted) {
  const int n = static_cast<int>(structure.size());
  const int count = static_cast<int>(count_wanted);
  const detail::ShiftInvert inverse(structure, detail::no_holds(n));
  arpack::Workspace work(n, count);
  arpack::iterate(inverse, n, count, work);

  const std::vector<int> select(static_cast<std::size_t>(work.subspace), 1);
  Eigen::VectorXd values(count);
  Eigen::MatrixXd vectors(n, count);
  int info = 0;
  dseupd_c(1, "A", select.data(), values.data(), vectors.data(), n, inverse.shift(), "G", n, "LM", count,
           arpack::kRoundingUnit, work.residual.data(), work.subspace, work.lanczos.data(), n, work.settings.data(),
           work.offsets.data(), work.vectors.data(), work.small.data(), static_cast<int>(work.small.size()), &info);
  if (info != 0) throw std::runtime_error("ARPACK's dseupd ended with info = " + std::to_string(info));
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&values](int a, int b) { return values(a) < values(b); });
  return detail::conventional_modes(structure, {values(order), vectors(Eigen::all, order)});
}

}  // namespace slipmode::fem
