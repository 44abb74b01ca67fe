#include <slipmode/core/coupled_parts.hpp>

#include <algorithm>
#include <numeric>

namespace slipmode {

std::vector<Part> coupled_parts(const Eigen::MatrixXd& A) {
  const Eigen::Index n = A.rows();
  std::vector<Part> parts;
  std::vector<bool> seen(static_cast<std::size_t>(n));
  for (Eigen::Index first = 0; first < n; ++first) {
    if (seen[static_cast<std::size_t>(first)]) continue;
    seen[static_cast<std::size_t>(first)] = true;
    Part part{first};
    for (std::size_t k = 0; k < part.size(); ++k)
      for (Eigen::Index i = 0; i < n; ++i)
        if (!seen[static_cast<std::size_t>(i)] && (A(i, part[k]) != 0.0 || A(part[k], i) != 0.0)) {
          seen[static_cast<std::size_t>(i)] = true;
          part.push_back(i);
        }
    std::ranges::sort(part);
    parts.push_back(std::move(part));
  }
  return parts;
}

Spectrum spectrum_by_parts(const std::vector<Part>& parts, const std::function<Spectrum(const Part&)>& solve) {
  if (parts.size() == 1) return solve(parts[0]);
  std::vector<double> values;
  std::vector<Eigen::VectorXd> vectors;
  Eigen::Index n = 0;
  for (const Part& part : parts) n += static_cast<Eigen::Index>(part.size());
  for (const Part& part : parts) {
    const Spectrum own = solve(part);
    for (Eigen::Index k = 0; k < own.values.size(); ++k) {
      values.push_back(own.values(k));
      vectors.emplace_back(Eigen::VectorXd::Zero(n))(part) = own.vectors.col(k);
    }
  }
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return values[k]; });
  const auto count = static_cast<Eigen::Index>(order.size());
  Spectrum all{Eigen::VectorXd(count), Eigen::MatrixXd(n, count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    all.values(k) = values[order[static_cast<std::size_t>(k)]];
    all.vectors.col(k) = vectors[order[static_cast<std::size_t>(k)]];
  }
  return all;
}

}  // namespace slipmode
