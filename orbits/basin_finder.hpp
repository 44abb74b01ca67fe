#pragma once

#include <slipmode/orbits/attractor.hpp>
#include <slipmode/orbits/gap_motion.hpp>
#include <slipmode/orbits/orbit_map.hpp>
#include <slipmode/orbits/trap.hpp>

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::orbits {

/// What starts end on.
struct BasinAttractor {
  enum class Kind : std::uint8_t {
    kOrbit,  ///< a stable periodic orbit
    kGap,    ///< the steady motions between the stops: one, or a continuum with a coordinate
    /// The ends of such a continuum of places: approached from beyond, a stop touched more lightly every period, for
    /// ever. Members of the closed continuum, but no start that ends there ever leaves the stop for good.
    kEdge,
    kChaotic,  ///< a motion that does not repeat, its largest exponent above zero
  } kind = Kind::kOrbit;

  PeriodicOrbit orbit = {};  ///< of kGap and kEdge the one in the middle; of kChaotic nothing
  /// Once per period of the drive, at its phase of time 0: the orbit, or 1,024 of kChaotic [N x p].
  Eigen::MatrixXd points = {};
  Eigen::VectorXd scale = {};  ///< how far each coordinate moves along an orbit [N]
  Trap trap = {};              ///< of an isolated orbit, about its first point
  Metric metric = {};          ///< of kChaotic: of `points`
  Eigen::MatrixXd cloud = {};  ///< of kChaotic: `points` in it
  double reach = 0.0;          ///< of kChaotic: in it, how near to the cloud its motion stays
  double exponent = std::numeric_limits<double>::quiet_NaN();  ///< of kChaotic: the largest [1/s]
  double exponent_error = std::numeric_limits<double>::quiet_NaN();
};

[[nodiscard]] const char* to_string(BasinAttractor::Kind kind);

/// Where one start ends.
struct BasinCell {
  static constexpr int kUndecided = -1;
  int attractor = kUndecided;  ///< index into the attractors
  int periods = 0;             ///< of the drive until it was known
  bool met_event = false;      ///< on the way, as reaching a stop
  double coordinate =
      std::numeric_limits<double>::quiet_NaN();  ///< GapMotion::coordinate, of kGap with a continuum, and kEdge
  std::string failure = {};                      ///< why the flow failed; empty: it did not
};

/// A largest exponent with its standard error [1/s].
struct MeasuredExponent {
  double value = 0.0, error = 0.0;
};

struct BasinOptions {
  /// Periods of the drive in which a start may enter a neighbourhood of a known attractor; then its motion is followed
  /// on its own, by `settle`.
  int patience = 128;
  MapOptions settle = {};
  int sample = 16;  ///< so many starts each way, evenly spread, are followed first to find attractors, ≥ 1
  /// The largest exponent of a motion that does not repeat within settle.max_periods. Empty: it stays undecided.
  std::function<MeasuredExponent(const dynamics::HybridSystem& system, const dynamics::State& state)> exponent = {};
};

/// Follows starts of one system to attractors that are known. Safe to use from several threads.
class BasinFinder {
 public:
  /// @throws InvalidInput  for options out of range, a drive without period
  BasinFinder(dynamics::HybridSystem system, BasinOptions options);

  /// An attractor that was met for the first time, in what it is described from.
  struct Found {
    int order = 0;  ///< of an orbit; 0: a motion that does not repeat
    dynamics::State state;
  };
  struct Arrival {
    BasinCell cell;
    std::optional<Found> found = {};  ///< where the attractor is not among those known
  };
  /// A function of the start and the attractors alone.
  /// @throws InvalidInput  for a start at another time than 0, and as simulate
  [[nodiscard]] Arrival follow(const dynamics::State& start, const std::vector<BasinAttractor>& known) const;

  /// An orbit by shooting with its multipliers, a motion that does not repeat by its exponent; with neighbourhoods.
  /// Nothing when it is neither stable nor chaotic by four standard errors.
  [[nodiscard]] std::optional<BasinAttractor> describe(const Found& found) const;
  /// Index among those known, or their number.
  [[nodiscard]] std::size_t index_of(const BasinAttractor& attractor, const std::vector<BasinAttractor>& known) const;

  /// The motion in the gap, where the structure, its contacts and its drive have one in closed form.
  [[nodiscard]] const std::optional<GapMotion>& gap() const { return gap_; }
  /// It, as an attractor, and its edge where it has one; nothing where none fits between the stops.
  [[nodiscard]] std::vector<BasinAttractor> gap_attractors() const;
  [[nodiscard]] const BasinOptions& options() const { return options_; }

 private:
  /// A motion on its way, once per period of the drive.
  struct Path {
    dynamics::State state;
    std::vector<int> stays = {};  ///< per attractor: periods spent near it, one after the other
    double beyond = 0.0;          ///< how far beyond the edge it was a period ago [m]
  };
  void advance(Path& path, BasinCell& out_cell) const;
  [[nodiscard]] double coordinate_of(BasinAttractor::Kind kind, const Eigen::VectorXd& x) const;
  [[nodiscard]] bool nears_edge(Path& path) const;
  [[nodiscard]] bool arrives(const std::vector<BasinAttractor>& known, Path& path, BasinCell& out_cell) const;
  void follow_on(const std::vector<BasinAttractor>& known, Path& path, Arrival& out_arrival) const;
  [[nodiscard]] BasinAttractor of_orbit(PeriodicOrbit orbit) const;
  [[nodiscard]] std::optional<BasinAttractor> stable_orbit(const Found& found) const;
  [[nodiscard]] std::optional<BasinAttractor> chaotic(const dynamics::State& state) const;
  [[nodiscard]] bool is_same(const BasinAttractor& a, const BasinAttractor& b) const;

  dynamics::HybridSystem system_;
  BasinOptions options_;
  double period_;
  std::optional<GapMotion> gap_;
};

}  // namespace slipmode::orbits
