#pragma once

#include <slipmode/diagnostics/series/shells.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace slipmode::diagnostics {

/// How distances are measured.
enum class Norm {
  kEuclidean,  ///< sqrt(Σ d_k²)
  kMaximum,    ///< max |d_k|
};

/// A neighbour and how far it is.
struct Neighbour {
  Eigen::Index index = 0;
  double distance = 0.0;
};

/// Points in a k-d tree, searched for neighbours that are not near in time.
///
/// Points are columns in time order; index differences are time differences. Ties go to the lower index, so that an
/// answer depends on the points alone. Queries are const and may run in several threads.
///
///     const NeighbourTree tree(delay_vectors(series, {.dimension = 3, .lag = 8}), Norm::kEuclidean);
///     const auto three = tree.nearest(17, 3, {.window = 50});
///
/// Building costs O(n log n); a query about O(log n) in few dimensions, O(n) in many. Own tree rather than a library's:
/// time windows, ties and counting over many radii at once belong to the search itself.
/// Source: Friedman, Bentley, Finkel, ACM Trans. Math. Software 3 (1977) 209.
class NeighbourTree {
 public:
  /// Which points may be neighbours of point i: j < limit with |i − j| > window.
  struct Allowed {
    Eigen::Index window = 0;  ///< of Theiler [samples]; 0: all but i itself
    Eigen::Index limit = -1;  ///< −1: no limit. For points whose future must be known
  };

  /// @param points  one column each, finite [d x n], n ≥ 1
  /// @throws InvalidInput  for no points or dimensions, or one that is not finite
  NeighbourTree(Eigen::MatrixXd points, Norm metric);

  [[nodiscard]] Eigen::Index size() const { return points_.cols(); }
  [[nodiscard]] const Eigen::MatrixXd& points() const { return points_; }

  /// The `count` nearest allowed points of point i, nearest first; fewer if fewer are allowed.
  [[nodiscard]] std::vector<Neighbour> nearest(Eigen::Index i, std::size_t count, const Allowed& allowed) const;

  /// The allowed points no farther from point i than `radius`, by rising index.
  [[nodiscard]] std::vector<Neighbour> within(Eigen::Index i, double radius, const Allowed& allowed) const;

  /// What a walk over the tree looked at.
  struct Work {
    std::int64_t boxes = 0, points = 0;
  };

  /// Shells about a point for add_shells, between radii that ascend. @throws InvalidInput  as Shells
  [[nodiscard]] Shells shells(std::span<const double> radii) const;

  /// Adds the number of points, i among them, in each shell about point i.
  /// @param out_counts  one per shell
  /// All shells in one walk: a box within one shell is counted whole.
  Work add_shells(Eigen::Index i, const Shells& shells, std::span<std::int64_t> out_counts) const;

  /// Shell about point i that holds point j.
  [[nodiscard]] std::size_t shell(Eigen::Index i, Eigen::Index j, const Shells& shells) const {
    return shells.of(power(points_.col(i).data(), points_.col(j).data()));
  }

  /// Distance of points i and j in the metric of the tree.
  [[nodiscard]] double distance(Eigen::Index i, Eigen::Index j) const;

 private:
  struct Node {
    Eigen::Index begin, end;  // of order_
    std::int32_t left = -1;   // −1: a leaf
    std::int32_t right = -1;
    Eigen::Index leaf = 0;  // a leaf's first number in leaves_
  };
  struct Range {
    double least, most;
  };

  std::int32_t build(Eigen::Index begin, Eigen::Index end);
  void store_leaf(Node& node);
  [[nodiscard]] static Eigen::Index filled_up(const Node& leaf);
  [[nodiscard]] double power(const double* a, const double* b) const;
  [[nodiscard]] double least(std::int32_t node, const double* x) const;
  [[nodiscard]] Range range(std::int32_t node, const double* x) const;
  void leaf_powers(const Node& leaf, const double* x, double* out) const;
  [[nodiscard]] double to_power(double distance) const { return euclidean_ ? distance * distance : distance; }
  [[nodiscard]] double from_power(double value) const;
  template <typename Visit>
  void visit(const double* x, const Visit& visit_leaf, double& reach) const;
  void count(std::int32_t node, const double* x, const Shells& shells, std::int64_t* out_counts, Work& out_work) const;

  Eigen::MatrixXd points_;           // in time order
  std::vector<double> leaves_;       // leaf by leaf, coordinate by coordinate, filled up with points at infinity
  std::vector<Eigen::Index> order_;  // time indices, leaf by leaf
  std::vector<Node> nodes_;
  std::vector<double> boxes_;  // per node: lower corner, upper corner
  bool euclidean_;
};

}  // namespace slipmode::diagnostics
