#pragma once

#include <slipmode/orbits/shooting.hpp>

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace slipmode::orbits {

/// What shooting solves for: states at the starts of the segments, and the period where it is unknown.
struct ShootingPoint {
  std::vector<dynamics::State> nodes;
  double period = 0.0;
};

/// Gives contacts that stick (node.modes) the velocity of their counterpart, with the least change of velocities.
void put_on_constraint(const dynamics::HybridSystem& system, dynamics::State& node);

/// The node as the flow takes it: modes are derived where they follow from the state.
[[nodiscard]] dynamics::State runnable(const dynamics::HybridSystem& system, dynamics::State node);

/// Units that make the coordinates (q, q̇, internal) of a periodic motion comparable, by two of its states [N].
[[nodiscard]] Eigen::VectorXd coordinate_scale(const dynamics::HybridSystem& system, const dynamics::State& one,
                                               const dynamics::State& other, double period);

/// Everything one pass over all segments gives. Vectors and matrices are scaled: coordinate i in units of scale[i].
struct ShootingEvaluation {
  ShootingPoint point;
  std::vector<dynamics::State> ends;      ///< of the segments
  std::vector<Eigen::MatrixXd> transfer;  ///< Φ of each segment [N x N]
  std::vector<Eigen::VectorXd> rate;      ///< ẋ at each end [N]
  std::vector<Eigen::VectorXd> mismatch;  ///< end of segment k less start of the next [N]
  std::vector<dynamics::Event> events;
  /// Half-way state and Φ up to it, where the system is its own mirror image and the order is odd; else empty.
  Eigen::VectorXd half_state;
  Eigen::MatrixXd half_transfer;
  double norm = std::numeric_limits<double>::infinity();     ///< root of the sum of squares of all mismatches
  double largest = std::numeric_limits<double>::infinity();  ///< largest entry of all mismatches
};

/// The linearised conditions of all segments with the inner nodes eliminated:
///
///     (Φ − s) δx₁ + columns · e + rest = 0,       Φ = Φ_m … Φ₁,   s = −1 for half periods, else 1.
struct CondensedShooting {
  Eigen::MatrixXd matrix;   ///< Φ − s [N x N]
  Eigen::MatrixXd columns;  ///< of the extra unknowns [N x e]
  Eigen::VectorXd rest;     ///< [N]
};

/// Multiple shooting on one system: residuals, Jacobians and steps. For one thread.
class ShootingProblem {
 public:
  ShootingProblem(const dynamics::HybridSystem& system, const ShootingOptions& options, OrbitKind kind);

  /// Segments' starts by simulation from `guess`, or options.segment_guesses.
  [[nodiscard]] ShootingPoint initial_point(const dynamics::State& guess, double period) const;

  /// The first evaluation sets the scales, unless `use_scale` has: residuals are relative to them.
  /// @throws NumericalFailure  when the flow fails
  [[nodiscard]] ShootingEvaluation evaluate(const ShootingPoint& point);
  void use_scale(const Eigen::VectorXd& scale) { scale_ = scale; }
  /// The state a time later, by the same flow.
  [[nodiscard]] dynamics::State end_of(const dynamics::State& start, double duration) {
    return run(start, duration).end;
  }
  struct Ends {
    Eigen::MatrixXd states;  ///< scaled, one column each [N x m]
    std::size_t events = 0;  ///< of all segments
  };
  /// The ends of all segments alone.
  [[nodiscard]] Ends ends_of(const ShootingPoint& point);

  /// @param extra  columns of extra unknowns, one [N x e] matrix per segment, scaled; may be empty
  [[nodiscard]] CondensedShooting condense(const ShootingEvaluation& at,
                                           const std::vector<Eigen::MatrixXd>& extra) const;
  /// d(end of each segment)/d(ln period), scaled: the extra column of a period that is unknown.
  [[nodiscard]] std::vector<Eigen::MatrixXd> period_columns(const ShootingEvaluation& at) const;

  /// The point a scaled step away. Nodes take over the modes of the ends before them, and their constraints.
  /// @param first   δx₁ [N]
  /// @param extra   values of the extra unknowns [e], of which the first is δ ln T when `period_unknown`
  /// @param share   share of the mismatches between inner nodes that the step is to close, 0 … 1
  [[nodiscard]] ShootingPoint moved(const ShootingEvaluation& at, const Eigen::VectorXd& first,
                                    const std::vector<Eigen::MatrixXd>& columns, const Eigen::VectorXd& extra,
                                    double share) const;

  [[nodiscard]] bool period_unknown() const { return kind_ == OrbitKind::kSelfExcited; }
  [[nodiscard]] OrbitKind kind() const { return kind_; }
  [[nodiscard]] const Eigen::VectorXd& scale() const { return scale_; }
  [[nodiscard]] const dynamics::HybridSystem& system() const { return system_; }
  [[nodiscard]] dynamics::TangentFlow& flow() { return flow_; }
  /// Time covered by the segments together, as a share of the period: ½ or 1.
  [[nodiscard]] double covered() const { return options_.half_period ? 0.5 : 1.0; }
  /// (x, ẋ, internal) in units of the scale [N].
  [[nodiscard]] Eigen::VectorXd scaled(const Eigen::VectorXd& x) const { return x.cwiseQuotient(scale_); }

 private:
  /// Without what the end changes by.
  [[nodiscard]] dynamics::TangentResult run(const dynamics::State& start, double duration);
  [[nodiscard]] Eigen::MatrixXd in_scale(const Eigen::MatrixXd& transfer) const;

  dynamics::HybridSystem system_;
  ShootingOptions options_;
  OrbitKind kind_;
  dynamics::TangentFlow flow_;
  Eigen::VectorXd scale_;
  bool in_halves_ = false;  ///< the one segment is run in two halves, to see the symmetry
};

/// Minimises ‖J d + r‖ for ‖d‖ ≤ radius (Levenberg, Marquardt, Moré), of minimum norm where J has no full rank.
struct BoundedLeastSquares {
  Eigen::VectorXd step;
  double predicted = 0.0;  ///< ‖J d + r‖
  double smallest = 0.0;   ///< smallest over largest singular value of J
};
[[nodiscard]] BoundedLeastSquares bounded_least_squares(const Eigen::MatrixXd& J, const Eigen::VectorXd& r,
                                                        double radius);

}  // namespace slipmode::orbits
