#pragma once

#include <slipmode/orbits/branches/special_curve.hpp>
#include <slipmode/studies/balance_search.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::studies {

/// Which special points of a branch are followed over a second key, and how far.
struct CurveRequest {
  std::string along;            ///< the second key
  double from = 0.0, to = 0.0;  ///< its range
  orbits::SpecialKind kind = orbits::SpecialKind::kFold;
  std::optional<double> near = {};  ///< the one nearest to this value of the first key; else all of them
};

/// "fold", "period-doubling", …: what can be followed.
[[nodiscard]] std::vector<std::string> followed_words();
/// KIND, or KIND:VALUE for the one nearest to a value of the first key.
/// @throws InvalidInput  for another kind, a value that is no number
void read_point(const std::string& text, CurveRequest& out_request);
[[nodiscard]] std::string point_text(const CurveRequest& request);

/// Where curves begin: the scene and its model over both keys.
struct CurvePlane {
  scene::Scene scene;  ///< at its own value of the second key where the range holds that, else at its first end
  Family family;
  double along = 0.0;  ///< that value
};
/// @throws InvalidInput  for a second key that is the first one, or cannot be varied continuously
[[nodiscard]] CurvePlane curve_plane(const scene::Scene& scene, const std::string& key,
                                     const std::optional<pod::NamedBasis>& basis, const ContinuationRequest& request,
                                     const CurveRequest& curve);

/// Curves of special points in the plane of two keys.
struct SpecialCurves {
  std::vector<results::NamedBranch> branches;  ///< that they leave, over the first key
  double start = 0.0;                          ///< where these begin
  double along = 0.0;                          ///< value of the second key there
  std::vector<results::NamedBranch> curves = {};
  std::vector<std::string> refused = {};  ///< special points of the kind that cannot be followed, and why
  bool interrupted = false;               ///< the stop flag was set: what was found before is there
};

/// Follows the special points of the kind of branches over the first key, by shooting those of orbits, by balance those
/// of balances. A point on a curve that was followed already is not followed again.
/// @param branches  of the plane's scene, as continue_orbit or continue_balance finds them from `start`
[[nodiscard]] SpecialCurves special_curves(const CurvePlane& plane, std::vector<results::NamedBranch> branches,
                                           double start, const ContinuationRequest& request, const CurveRequest& curve,
                                           const orbits::ShootingOptions& shooting, const RunOptions& run = {});

/// @throws InvalidInput  where an error or certificates are asked of curves by balance
void require_no_certificate(const BalanceSearch& search);

/// The model over both keys, at the values where the curves begin.
[[nodiscard]] Family plane_of(const scene::Scene& scene, const std::string& key,
                              const std::optional<pod::NamedBasis>& basis, const CurveRequest& curve,
                              const SpecialCurves& found);

/// Why there are no curves: which special points the branches have instead. Empty where there are some.
[[nodiscard]] std::string nothing_followed(const SpecialCurves& found, const std::string& key,
                                           const ContinuationRequest& request, const CurveRequest& curve);

/// @param continuation  the command that follows the branches
[[nodiscard]] std::string command_of(const std::string& continuation, const CurveRequest& curve);

/// What is kept of curves. @param model  plane_of
[[nodiscard]] results::Content content_of(const Family& model, std::shared_ptr<const SpecialCurves> found,
                                          const std::string& command, const RunOptions& run = {});

}  // namespace slipmode::studies
