#include <slipmode/trade/case.hpp>

#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/solver_options.hpp>

namespace slipmode::trade {

namespace {

diagnostics::Readings readings_of(const scene::Scene& scene, const dynamics::HybridSystem& system,
                                  const fem::Beam* beam) {
  if (beam != nullptr && scene.drive.shaker() != nullptr) {
    return {.rows = beam->curvature_row(scene::gauge_position(scene)).transpose(), .offset = {}};
  }
  return {.rows = system.contacts().front().direction.transpose(), .offset = {}};
}

bool same_mesh(const Case& a, const Case& b) {
  return a.beam == nullptr || b.beam == nullptr || a.beam->nodes() == b.beam->nodes();
}

/// Degrees of freedom on `to` of the deflection that `q` is on `from`.
Eigen::VectorXd resampled(const fem::Beam& from, const fem::Beam& to, const Eigen::VectorXd& q) {
  const auto count = static_cast<Eigen::Index>(to.nodes().size());
  Eigen::VectorXd value = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(count);
  for (Eigen::Index k = 1; k < count; ++k) {
    const double x = to.nodes()[static_cast<std::size_t>(k)];
    value(k) = from.displacement_row(x).dot(q);
    slope(k) = from.slope_row(x).dot(q);
  }
  return to.interpolate(value, slope);
}

bool same_laws(const dynamics::HybridSystem& a, const dynamics::HybridSystem& b) {
  if (a.internal_size() != b.internal_size()) return false;
  for (std::size_t c = 0; c < a.contacts().size(); ++c) {
    if (a.contacts()[c].law.index() != b.contacts()[c].law.index()) return false;
  }
  return true;
}

}  // namespace

Case build_case(const Variant& variant, const std::vector<OfferedBasis>& bases) {
  const scene::Scene& scene = variant.scene;
  std::shared_ptr<const fem::Beam> beam;
  if (scene.beam() != nullptr) beam = std::make_shared<const fem::Beam>(scene::build_beam(scene));
  const dynamics::HybridSystem full = beam ? scene::build_system(scene, *beam) : scene::build_system(scene);
  diagnostics::DrivenCase model{.system = full, .readings = readings_of(scene, full, beam.get())};
  const std::optional<pod::Basis> basis = basis_of(variant, bases, full);
  if (basis) model = diagnostics::reduced_case(model, *basis);
  dynamics::FlowOptions flow = scene::uncertified(scene.flow);
  flow.audit = false;
  return {.model = std::move(model), .full = full, .basis = basis, .beam = std::move(beam), .flow = flow};
}

dynamics::State handed_on(const Case& from, const Case& to, const dynamics::State& state) {
  dynamics::State here = from.basis ? rom::lift(*from.basis, state) : state;
  if (!same_mesh(from, to)) {
    here.q = resampled(*from.beam, *to.beam, here.q);
    here.v = resampled(*from.beam, *to.beam, here.v);
  }
  if (to.basis) here = rom::restrict_state(to.full.structure(), *to.basis, here);
  here.modes.clear();
  if (!same_laws(from.full, to.full)) here.internal.resize(0);
  return here;
}

}  // namespace slipmode::trade
