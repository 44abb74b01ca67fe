#include <slipmode/orbits/shooting.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/orbit_search.hpp>
#include "python/call.hpp"
#include "python/errors.hpp"
#include "python/model.hpp"
#include "python/module.hpp"
#include "python/result.hpp"

#include <fmt/format.h>
#include <pybind11/eigen.h>

#include <optional>
#include <utility>

namespace slipmode::python {
namespace {

using scene::Scene;

/// Where Newton's method begins: "settle", "initial", or displacements and velocities.
void read_start(Keywords& keywords, Eigen::Index n, studies::OrbitSearch& out_search) {
  const py::object start = keywords.take("start");
  if (!start) return;
  const std::string expected = fmt::format("\"settle\", \"initial\", or {} displacements and {} velocities", n, n);
  if (py::isinstance<py::str>(start)) {
    const auto word = start.cast<std::string>();
    if (word != "settle" && word != "initial") keywords.refuse("start", start, expected);
    out_search.settles = word == "settle";
    return;
  }
  py::detail::make_caster<Eigen::VectorXd> numbers;
  if (!numbers.load(start, true)) keywords.refuse("start", start, expected);
  const Eigen::VectorXd& x = numbers;
  if (x.size() != 2 * n || !x.allFinite()) keywords.refuse("start", start, expected);
  out_search.guess = dynamics::State{.q = x.head(n), .v = x.tail(n)};
}

studies::OrbitSearch search_of(Keywords& keywords, const Scene& scene) {
  studies::OrbitSearch search;
  keywords.read(search);
  read_start(keywords, scene.size(), search);
  return search;
}

/// Newton's method did not arrive: how far it came is the failure's state.
[[noreturn]] void raise_not_found(const orbits::ShootingResult& result) {
  const dynamics::State& best = result.orbit.start;
  Eigen::VectorXd state(best.q.size() + best.v.size());
  state << best.q, best.v;
  raise(NumericalFailure(
      fmt::format("no orbit from this guess ({}): {}", orbits::to_string(result.status), result.message), best.time,
      state, result.orbit.residual));
}

Result find_orbit(const Scene& scene, const py::kwargs& given) {
  Keywords keywords("find_orbit", given);
  const studies::OrbitSearch search = search_of(keywords, scene);
  const ModelChoice choice(keywords);
  Call call(keywords);
  const auto [found, result] = call([&] {
    const studies::Family family(scene, {}, choice.basis(scene, call.options()));
    call.options().check_interrupt();
    orbits::ShootingResult search_result = studies::find_orbit(family, search);
    std::optional<Result> kept;
    if (search_result.converged())
      kept.emplace(studies::content_of(family, std::make_shared<const orbits::PeriodicOrbit>(search_result.orbit)));
    return std::pair(std::move(search_result), std::move(kept));
  });
  if (!result) raise_not_found(found);
  return *result;
}

Result continue_orbit(const Scene& scene, const std::string& over, double to, const std::optional<double>& from,
                      const py::kwargs& given) {
  Keywords keywords("continue_orbit", given);
  const studies::OrbitSearch search = search_of(keywords, scene);
  studies::ContinuationRequest request;
  keywords.read(request);
  request.to = to;
  request.from = from ? *from : scene::get_continuous_key(scene, over);
  if (request.from == request.to)
    throw InvalidInput(fmt::format("continue_orbit: to = {}: the range has no length", to));
  const ModelChoice choice(keywords);
  Call call(keywords);
  const auto [found, result] = call([&] {
    const auto basis = choice.basis(scene, call.options());
    studies::Continuation continuation = studies::continue_orbit(scene, over, basis, search, request, call.options());
    std::optional<Result> kept;
    if (continuation.found.converged()) {
      kept.emplace(studies::content_of(studies::Family(scene, {over}, basis), continuation.start,
                                       std::make_shared<const std::vector<results::NamedBranch>>(continuation.branches),
                                       studies::command_of(over, choice.word(), search, request), call.options()));
    }
    return std::pair(std::move(continuation), std::move(kept));
  });
  if (!result) raise_not_found(found.found);
  const orbits::Branch& main = found.branches.front().branch;
  if (main.end == orbits::BranchEnd::kLost) {
    const bool any = !main.points.empty();
    raise(NumericalFailure("the branch was lost before the end of its range; what was found is kept: " + main.reason,
                           any ? main.points.back().parameter : found.start, {}, 0.0),
          py::cast(*result));
  }
  return *result;
}

}  // namespace

void add_orbits(py::module_& module) {
  const std::string search =
      "    start: \"settle\" (a run from [initial]), \"initial\", or displacements and velocities\n" + model_text() +
      options_text<studies::OrbitSearch>();
  module.def("find_orbit", &find_orbit, py::arg("scene"),
             ("A periodic orbit, its multipliers and one period of it.\n\n" + search + call_text()).c_str());
  module.def("continue_orbit", &continue_orbit, py::arg("scene"), py::arg("over"), py::arg("to"),
             py::arg("from_") = py::none(),
             ("Branches of periodic orbits over a key. They begin at the scene's own value of the key where the range\n"
              "holds it, and go both ways; else at `from_`.\n\n"
              "    over: key of the scene, e.g. \"drive.omega\"\n    to: end of the range\n"
              "    from_: its beginning; by default the scene's own value\n" +
              search + options_text<studies::ContinuationRequest>() + call_text())
                 .c_str());
}

}  // namespace slipmode::python
