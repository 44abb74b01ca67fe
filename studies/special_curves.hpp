#pragma once

#include <slipmode/orbits/special_curve.hpp>
#include <slipmode/studies/orbit_search.hpp>

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

/// Curves of special points in the plane of two keys.
struct SpecialCurves {
  Continuation base;   ///< the branches they leave, over the first key
  double along = 0.0;  ///< value of the second key there
  std::vector<results::NamedBranch> curves = {};
  std::vector<std::string> refused = {};  ///< special points of the kind that cannot be followed, and why
  bool interrupted = false;               ///< the stop flag was set: what was found before is there
};

/// Finds branches over a key as continue_orbit does, at the scene's own value of the second key where its range holds
/// that, else at its first end; then follows their special points of the kind. A point on a curve that was followed
/// already is not followed again.
/// @throws InvalidInput  for a second key that is the first one, or cannot be varied continuously; as continue_orbit
[[nodiscard]] SpecialCurves special_curves(const scene::Scene& scene, const std::string& key,
                                           const std::optional<pod::NamedBasis>& basis, const OrbitSearch& search,
                                           const ContinuationRequest& request, const CurveRequest& curve,
                                           const RunOptions& run = {});

/// The model over both keys, at the values where the curves begin.
[[nodiscard]] Family plane_of(const scene::Scene& scene, const std::string& key,
                              const std::optional<pod::NamedBasis>& basis, const CurveRequest& curve,
                              const SpecialCurves& found);

/// Why there are no curves: which special points the branches have instead. Empty where there are some.
[[nodiscard]] std::string nothing_followed(const SpecialCurves& found, const std::string& key,
                                           const ContinuationRequest& request, const CurveRequest& curve);

/// As studies::command_of of a continuation.
[[nodiscard]] std::string command_of(const std::string& key, const std::string& model, const OrbitSearch& search,
                                     const ContinuationRequest& request, const CurveRequest& curve);

/// What is kept of curves. @param model  plane_of
[[nodiscard]] results::Content content_of(const Family& model, std::shared_ptr<const SpecialCurves> found,
                                          const std::string& command, const RunOptions& run = {});

}  // namespace slipmode::studies
