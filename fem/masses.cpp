#include <slipmode/fem/masses.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <cmath>

namespace slipmode::fem {

namespace {

using Triplet = Eigen::Triplet<double>;

void check(const MassesOptions& options) {
  if (options.mass.empty()) throw InvalidInput("masses: none given; expected at least one mass");
  for (std::size_t i = 0; i < options.mass.size(); ++i) {
    if (options.mass[i] > 0.0 && std::isfinite(options.mass[i])) continue;
    throw InvalidInput(fmt::format("masses: mass[{}] = {}; expected a finite value > 0", i + 1, options.mass[i]));
  }
  const int count = static_cast<int>(options.mass.size());
  for (std::size_t l = 0; l < options.links.size(); ++l) {
    const Link& link = options.links[l];
    const auto outside = [count](int end) { return end < 0 || end > count; };
    if (outside(link.first) || outside(link.second) || link.first == link.second) {
      throw InvalidInput(
          fmt::format("masses: link {} joins {} and {}; expected two different masses from 1 to {}, or 0 "
                      "for ground",
                      l + 1, link.first, link.second, count));
    }
    for (const double value : {link.stiffness, link.damping}) {
      if (value >= 0.0 && std::isfinite(value)) continue;
      throw InvalidInput(fmt::format("masses: link {} has stiffness {} and damping {}; expected finite values >= 0",
                                     l + 1, link.stiffness, link.damping));
    }
  }
}

SparseMatrix assemble(const MassesOptions& options, double Link::*value) {
  std::vector<Triplet> entries;
  for (const Link& link : options.links) {
    if (link.first > 0) entries.emplace_back(link.first - 1, link.first - 1, link.*value);
    if (link.second > 0) entries.emplace_back(link.second - 1, link.second - 1, link.*value);
    if (link.first > 0 && link.second > 0) {
      entries.emplace_back(link.first - 1, link.second - 1, -(link.*value));
      entries.emplace_back(link.second - 1, link.first - 1, -(link.*value));
    }
  }
  const auto n = static_cast<Eigen::Index>(options.mass.size());
  SparseMatrix A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

}  // namespace

Structure masses(const MassesOptions& options) {
  check(options);
  std::vector<Triplet> diagonal;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < options.mass.size(); ++i) {
    const int at = static_cast<int>(i);
    diagonal.emplace_back(at, at, options.mass[i]);
    names.push_back(fmt::format("x{}", i + 1));
  }
  const auto n = static_cast<Eigen::Index>(options.mass.size());
  SparseMatrix M(n, n);
  M.setFromTriplets(diagonal.begin(), diagonal.end());
  return {std::move(M), assemble(options, &Link::damping), assemble(options, &Link::stiffness), std::move(names),
          options.units};
}

}  // namespace slipmode::fem
