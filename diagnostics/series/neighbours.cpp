#include <slipmode/diagnostics/series/neighbours.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace slipmode::diagnostics {

namespace {

constexpr Eigen::Index kLeaf = 64, kGroup = 8;  // points of a leaf, and those whose distances are found at once
constexpr std::size_t kDeepest = 128;           // twice the bits of an index: halves can never nest deeper

bool nearer(const Neighbour& a, const Neighbour& b) {
  return std::tie(a.distance, a.index) < std::tie(b.distance, b.index);
}

bool may_be(Eigen::Index i, Eigen::Index j, const NeighbourTree::Allowed& allowed) {
  return (allowed.limit < 0 || j < allowed.limit) && std::abs(i - j) > allowed.window;
}

}  // namespace

NeighbourTree::NeighbourTree(Eigen::MatrixXd points, Norm metric)
    : points_(std::move(points)), euclidean_(metric == Norm::kEuclidean) {
  if (points_.size() == 0 || !points_.allFinite()) {
    throw InvalidInput(fmt::format("neighbour search: expected finite points, found {} of dimension {}{}",
                                   points_.cols(), points_.rows(),
                                   points_.size() == 0 ? "" : ", one of them not finite"));
  }
  order_.resize(static_cast<std::size_t>(points_.cols()));
  std::iota(order_.begin(), order_.end(), Eigen::Index{0});
  build(0, points_.cols());
}

Eigen::Index NeighbourTree::filled_up(const Node& leaf) {
  return (leaf.end - leaf.begin + kGroup - 1) / kGroup * kGroup;
}

void NeighbourTree::store_leaf(Node& node) {
  node.leaf = static_cast<Eigen::Index>(leaves_.size());
  const Eigen::Index wide = filled_up(node);
  leaves_.resize(leaves_.size() + static_cast<std::size_t>(wide * points_.rows()),
                 std::numeric_limits<double>::infinity());
  for (Eigen::Index j = node.begin; j < node.end; ++j) {
    for (Eigen::Index k = 0; k < points_.rows(); ++k) {
      leaves_[static_cast<std::size_t>(node.leaf + k * wide + j - node.begin)] =
          points_(k, order_[static_cast<std::size_t>(j)]);
    }
  }
}

std::int32_t NeighbourTree::build(Eigen::Index begin, Eigen::Index end) {
  const auto node = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back({.begin = begin, .end = end});
  Eigen::VectorXd low = points_.col(order_[static_cast<std::size_t>(begin)]), high = low;
  for (Eigen::Index k = begin + 1; k < end; ++k) {
    low = low.cwiseMin(points_.col(order_[static_cast<std::size_t>(k)]));
    high = high.cwiseMax(points_.col(order_[static_cast<std::size_t>(k)]));
  }
  boxes_.insert(boxes_.end(), low.begin(), low.end());
  boxes_.insert(boxes_.end(), high.begin(), high.end());
  if (end - begin <= kLeaf) {
    store_leaf(nodes_.back());
    return node;
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const Eigen::Index middle = begin + (end - begin) / 2;
  std::nth_element(
      order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
      [&](Eigen::Index a, Eigen::Index b) { return std::pair(points_(axis, a), a) < std::pair(points_(axis, b), b); });
  const std::int32_t left = build(begin, middle);
  const std::int32_t right = build(middle, end);
  nodes_[static_cast<std::size_t>(node)].left = left;
  nodes_[static_cast<std::size_t>(node)].right = right;
  return node;
}

double NeighbourTree::from_power(double value) const { return euclidean_ ? std::sqrt(value) : value; }

double NeighbourTree::power(const double* a, const double* b) const {
  double value = 0.0;
  if (euclidean_) {
    for (Eigen::Index k = 0; k < points_.rows(); ++k) value += (a[k] - b[k]) * (a[k] - b[k]);
  } else {
    for (Eigen::Index k = 0; k < points_.rows(); ++k) value = std::max(value, std::abs(a[k] - b[k]));
  }
  return value;
}

double NeighbourTree::least(std::int32_t node, const double* x) const {
  const double* low = boxes_.data() + 2 * points_.rows() * node;
  const double* high = low + points_.rows();
  double value = 0.0;
  for (Eigen::Index k = 0; k < points_.rows(); ++k) {
    const double gap = std::max(0.0, std::max(low[k] - x[k], x[k] - high[k]));
    value = euclidean_ ? value + gap * gap : std::max(value, gap);
  }
  return value;
}

/// Between which powers those of the distances to all points of a node lie.
NeighbourTree::Range NeighbourTree::range(std::int32_t node, const double* x) const {
  const double* low = boxes_.data() + 2 * points_.rows() * node;
  const double* high = low + points_.rows();
  Range value{0.0, 0.0};
  for (Eigen::Index k = 0; k < points_.rows(); ++k) {
    const double above = x[k] - low[k], below = high[k] - x[k];
    const double near = std::max(0.0, std::max(-above, -below)), far = std::max(std::abs(above), std::abs(below));
    value = euclidean_ ? Range{value.least + near * near, value.most + far * far}
                       : Range{std::max(value.least, near), std::max(value.most, far)};
  }
  return value;
}

/// power() of all points of a leaf; infinite for those that fill it up.
void NeighbourTree::leaf_powers(const Node& leaf, const double* x, double* out) const {
  using Group = Eigen::Array<double, kGroup, 1>;
  const Eigen::Index wide = filled_up(leaf);
  for (Eigen::Index j = 0; j < wide; j += kGroup) {
    const double* at = leaves_.data() + leaf.leaf + j;
    Group value = Group::Zero();
    for (Eigen::Index k = 0; k < points_.rows(); ++k, at += wide) {
      const Group gap = x[k] - Eigen::Map<const Group>(at);
      value = euclidean_ ? Group(value + gap * gap) : Group(value.max(gap.abs()));
    }
    Eigen::Map<Group>(out + j) = value;
  }
}

double NeighbourTree::distance(Eigen::Index i, Eigen::Index j) const {
  return from_power(power(points_.col(i).data(), points_.col(j).data()));
}

/// Leaves that may hold points within `reach` (a power of a distance, which the visitor may lower), the nearer child
/// of a node first.
template <typename Visit>
void NeighbourTree::visit(const double* x, const Visit& visit_leaf, double& reach) const {
  std::pair<std::int32_t, double> stack[kDeepest];
  std::size_t depth = 0;
  stack[depth++] = {0, least(0, x)};
  while (depth > 0) {
    const auto [id, gap] = stack[--depth];
    if (gap > reach) continue;
    const Node& node = nodes_[static_cast<std::size_t>(id)];
    if (node.left < 0) {
      visit_leaf(node);
      continue;
    }
    const double left = least(node.left, x), right = least(node.right, x);
    const bool left_first = left <= right;
    stack[depth++] = left_first ? std::pair(node.right, right) : std::pair(node.left, left);
    stack[depth++] = left_first ? std::pair(node.left, left) : std::pair(node.right, right);
  }
}

std::vector<Neighbour> NeighbourTree::nearest(Eigen::Index i, std::size_t count, const Allowed& allowed) const {
  std::vector<Neighbour> found;
  if (count == 0) return found;
  found.reserve(count + 1);
  const double* x = points_.col(i).data();
  double reach = std::numeric_limits<double>::infinity();
  double powers[kLeaf];
  const auto take_leaf = [&](const Node& node) {
    leaf_powers(node, x, powers);
    for (Eigen::Index k = node.begin; k < node.end; ++k) {
      const Neighbour candidate{.index = order_[static_cast<std::size_t>(k)], .distance = powers[k - node.begin]};
      if (candidate.distance > reach || !may_be(i, candidate.index, allowed)) continue;
      found.insert(std::upper_bound(found.begin(), found.end(), candidate, nearer), candidate);
      if (found.size() > count) found.pop_back();
      if (found.size() == count) reach = found.back().distance;
    }
  };
  visit(x, take_leaf, reach);
  for (Neighbour& neighbour : found) neighbour.distance = from_power(neighbour.distance);
  return found;
}

std::vector<Neighbour> NeighbourTree::within(Eigen::Index i, double radius, const Allowed& allowed) const {
  std::vector<Neighbour> found;
  const double* x = points_.col(i).data();
  double reach = to_power(radius);
  double powers[kLeaf];
  const auto take_leaf = [&](const Node& node) {
    leaf_powers(node, x, powers);
    for (Eigen::Index k = node.begin; k < node.end; ++k) {
      const double value = powers[k - node.begin];
      const Eigen::Index j = order_[static_cast<std::size_t>(k)];
      if (value <= reach && may_be(i, j, allowed)) found.push_back({.index = j, .distance = from_power(value)});
    }
  };
  visit(x, take_leaf, reach);
  std::sort(found.begin(), found.end(), [](const Neighbour& a, const Neighbour& b) { return a.index < b.index; });
  return found;
}

Shells NeighbourTree::shells(std::span<const double> radii) const {
  std::vector<double> powers(radii.size());
  std::transform(radii.begin(), radii.end(), powers.begin(), [&](double r) { return to_power(r); });
  return Shells(powers);
}

NeighbourTree::Work NeighbourTree::add_shells(Eigen::Index i, const Shells& shells,
                                              std::span<std::int64_t> out_counts) const {
  Work work;
  count(0, points_.col(i).data(), shells, out_counts.data(), work);
  return work;
}

void NeighbourTree::count(std::int32_t id, const double* x, const Shells& shells, std::int64_t* out_counts,
                          Work& out_work) const {
  ++out_work.boxes;
  const Range box = range(id, x);
  const std::size_t low = shells.of(box.least);
  const Node& node = nodes_[static_cast<std::size_t>(id)];
  if (low + 1 == shells.count() || low == shells.of(box.most)) {
    out_counts[low] += node.end - node.begin;
  } else if (node.left < 0) {
    out_work.points += node.end - node.begin;
    double powers[kLeaf];
    leaf_powers(node, x, powers);
    for (Eigen::Index k = 0; k < node.end - node.begin; ++k) ++out_counts[shells.of(powers[k])];
  } else {
    count(node.left, x, shells, out_counts, out_work);
    count(node.right, x, shells, out_counts, out_work);
  }
}

}  // namespace slipmode::diagnostics
