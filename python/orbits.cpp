#include <slipmode/orbits/shooting.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/studies/balance_search.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/orbit_search.hpp>
#include <slipmode/studies/orbit_spectra.hpp>
#include <slipmode/studies/skeletons.hpp>
#include <slipmode/studies/special_curves.hpp>
#include "python/call.hpp"
#include "python/errors.hpp"
#include "python/model.hpp"
#include "python/module.hpp"
#include "python/result.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/eigen.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

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

/// Newton's method did not arrive: how far it came is the failure's state.
[[noreturn]] void raise_not_found(const orbits::ShootingResult& result) {
  const dynamics::State& best = result.orbit.start;
  Eigen::VectorXd state(best.q.size() + best.v.size());
  state << best.q, best.v;
  raise(NumericalFailure(
      fmt::format("no orbit from this guess ({}): {}", orbits::to_string(result.status), result.message), best.time,
      state, result.orbit.residual));
}

struct BranchCertificates {
  int every = 0;
  static constexpr auto fields() {
    return std::tuple{optional("every", &BranchCertificates::every, "",
                               "with certify: every so many points, and the last; 0: all", kFromZero)};
  }
  [[nodiscard]] std::optional<int> points() const { return every > 0 ? std::optional(every) : std::nullopt; }
};

/// How an orbit is looked for.
struct Method {
  bool balances = false, mixes = false;
  studies::OrbitSearch search;
  studies::BalanceWords words;     ///< of either, as they were given, with
  std::string start = "settle";    ///< and
  studies::BalanceSearch balance;  ///< what they say
  studies::MixedSearch mixed;      ///< likewise
};

/// @param ways  words of `by`
Method method_of(Keywords& keywords, const Scene& scene, const std::vector<std::string>& ways) {
  Method method;
  const std::string by = keywords.text("by", "shooting");
  if (std::ranges::find(ways, by) == ways.end())
    keywords.refuse("by", py::str(by), fmt::format("one of {}", fmt::join(ways, ", ")));
  method.balances = by == "balance";
  method.mixes = by == "mixed";
  keywords.read(method.search);
  if (!method.balances && !method.mixes) {
    read_start(keywords, scene.size(), method.search);
    return method;
  }
  keywords.read(method.words);
  if (method.words.error && !method.words.harmonics) method.words.harmonics = "auto";
  const py::object start = keywords.take("start");
  if (start && !py::isinstance<py::str>(start)) keywords.refuse("start", start, "\"contact\" or \"gap\"");
  if (start) method.start = start.cast<std::string>();
  if (method.balances)
    method.balance = studies::balance_search(method.words, method.start, method.search.order);
  else
    method.mixed = studies::mixed_search(method.words, method.start, method.search.order);
  return method;
}

orbits::ShootingOptions certifying(const studies::OrbitSearch& search) {
  return {.segments = search.segments, .tolerance = search.tolerance};
}

/// Newton's method found no balance, or none that meets the error.
void require_balance(const studies::BalanceFound& found, const std::vector<orbits::OrderTrial>& trials,
                     const std::optional<Result>& kept) {
  if (found.balance.converged && found.met) return;
  const std::string why = found.balance.converged ? studies::not_met(trials) : found.balance.message;
  raise(NumericalFailure(why, 0.0, {}, found.balance.residual), kept ? py::cast(*kept) : py::none());
}

Result find_balance(const Scene& scene, const Method& method, const ModelChoice& choice, Call& call) {
  const auto [found, result] = call([&] {
    const studies::Family family(scene, {}, choice.basis(scene, call.options()));
    call.options().check_interrupt();
    const auto own = std::make_shared<const studies::BalanceFound>(
        studies::find_balance(family, method.balance, certifying(method.search)));
    std::optional<Result> kept;
    if (own->balance.converged) kept.emplace(studies::content_of(family, own));
    return std::pair(own, std::move(kept));
  });
  require_balance(*found, found->trials, result);
  return *result;
}

Result find_mixed(const Scene& scene, const Method& method, const ModelChoice& choice, Call& call) {
  if (!method.mixed.certify && !method.mixed.error)
    throw InvalidInput(
        "find_orbit: by = 'mixed': what is kept of a mixed orbit is the exact orbit behind it; add certify=True");
  const auto [found, result] = call([&] {
    const studies::Family family(scene, {}, choice.basis(scene, call.options()));
    call.options().check_interrupt();
    const auto own = std::make_shared<const studies::MixedFound>(
        studies::find_mixed(family, method.mixed, certifying(method.search)));
    std::optional<Result> kept;
    if (own->certificate && own->certificate->behind) kept.emplace(studies::content_of(family, own));
    return std::pair(own, std::move(kept));
  });
  if (result && found->met) return *result;
  std::string why = found->mixed.message;
  if (found->mixed.converged) why = found->met ? found->certificate->verdict : studies::not_met(found->trials);
  raise(NumericalFailure(why, 0.0, {}, found->mixed.residual), result ? py::cast(*result) : py::none());
}

Result find_orbit(const Scene& scene, const py::kwargs& given) {
  Keywords keywords("find_orbit", given);
  const Method method = method_of(keywords, scene, {"shooting", "balance", "mixed"});
  const studies::OrbitSearch& search = method.search;
  const ModelChoice choice(keywords);
  Call call(keywords);
  if (method.balances) return find_balance(scene, method, choice, call);
  if (method.mixes) return find_mixed(scene, method, choice, call);
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

/// A branch that was lost on its way: what was found is the failure's result.
void require_whole(const orbits::Branch& branch, double start, const Result& kept) {
  if (branch.end != orbits::BranchEnd::kLost) return;
  raise(NumericalFailure("the branch was lost before the end of its range; what was found is kept: " + branch.reason,
                         branch.points.empty() ? start : branch.points.back().parameter, {}, 0.0),
        py::cast(kept));
}

Result continue_balance(const Scene& scene, const std::string& over, const Method& method,
                        const studies::ContinuationRequest& request, const BranchCertificates& certificates,
                        const ModelChoice& choice, Call& call) {
  const std::optional<int> every = certificates.points();
  const auto [found, result] = call([&] {
    const auto basis = choice.basis(scene, call.options());
    studies::BalanceContinuation own = studies::continue_balance(scene, over, basis, method.balance, request, every,
                                                                 certifying(method.search), call.options());
    call.options().check_interrupt();
    std::optional<Result> kept;
    if (!own.branch.points.empty())
      kept.emplace(studies::content_of(
          studies::Family(scene, {over}, basis), own.start, studies::branches_of(own),
          studies::command_of(over, choice.word(), method.search, method.words, method.start, every, request),
          call.options()));
    return std::pair(std::move(own), std::move(kept));
  });
  require_balance(found.found, found.trials.empty() ? found.found.trials : found.trials, result);
  require_whole(found.branch, found.start, *result);
  return *result;
}

/// Special points over a second key, where one was given: (key, from, to).
std::optional<studies::CurveRequest> curve_request(Keywords& keywords) {
  const py::object along = keywords.take("along");
  const std::string point = keywords.text("point");
  if (!along && point.empty()) return std::nullopt;
  py::detail::make_caster<std::tuple<std::string, double, double>> read;
  if (!along || !read.load(along, true)) keywords.refuse("along", along ? along : py::none(), "(key, from, to)");
  if (point.empty())
    keywords.refuse("point", py::str(point), fmt::format("one of {}", fmt::join(studies::followed_words(), ", ")));
  const auto [key, from, to] = py::detail::cast_op<std::tuple<std::string, double, double>>(read);
  if (from == to) keywords.refuse("along", along, "a range with a length");
  studies::CurveRequest request{.along = key, .from = from, .to = to};
  studies::read_point(point, request);
  return request;
}

/// What curves leave, by shooting or by balance; one of the two found none where `branches` is empty.
struct CurveBase {
  std::vector<results::NamedBranch> branches = {};
  double start = 0.0;
  orbits::ShootingResult orbit = {};
  studies::BalanceFound balance = {};
  orbits::ShootingOptions shooting = {};
  std::string command;
};

CurveBase curve_base(const studies::CurvePlane& plane, const std::optional<pod::NamedBasis>& basis,
                     const std::string& over, const Method& method, const std::optional<int>& every,
                     const studies::ContinuationRequest& request, const std::string& model,
                     const studies::RunOptions& run) {
  const studies::OrbitSearch& search = method.search;
  if (method.balances) {
    studies::require_no_certificate(method.balance);
    studies::BalanceContinuation found =
        studies::continue_balance(plane.scene, over, basis, method.balance, request, every, certifying(search), run);
    CurveBase out{.start = found.start,
                  .shooting = {.tolerance = search.tolerance},
                  .command = studies::command_of(over, model, search, method.words, method.start, every, request)};
    if (!found.branch.points.empty()) out.branches = *studies::branches_of(found);
    out.balance = std::move(found.found);
    return out;
  }
  studies::Continuation found = studies::continue_orbit(plane.scene, over, basis, search, request, run);
  return {.branches = std::move(found.branches),
          .start = found.start,
          .orbit = std::move(found.found),
          .shooting = studies::shooting_options(plane.family, search),
          .command = studies::command_of(over, model, search, request)};
}

Result continue_special(const Scene& scene, const std::string& over, const Method& method,
                        const studies::ContinuationRequest& request, const BranchCertificates& certificates,
                        const studies::CurveRequest& curve, const ModelChoice& choice, Call& call) {
  const auto [base, found, result] = call([&] {
    const auto basis = choice.basis(scene, call.options());
    const studies::CurvePlane plane = studies::curve_plane(scene, over, basis, request, curve);
    CurveBase own =
        curve_base(plane, basis, over, method, certificates.points(), request, choice.word(), call.options());
    std::shared_ptr<const studies::SpecialCurves> curves;
    std::optional<Result> kept;
    if (!own.branches.empty()) {
      curves = std::make_shared<const studies::SpecialCurves>(studies::special_curves(
          plane, std::move(own.branches), own.start, request, curve, own.shooting, call.options()));
      call.options().check_interrupt();
      if (!curves->curves.empty())
        kept.emplace(studies::content_of(studies::plane_of(scene, over, basis, curve, *curves), curves,
                                         studies::command_of(own.command, curve), call.options()));
    }
    return std::tuple(std::move(own), curves, std::move(kept));
  });
  if (!found && method.balances) require_balance(base.balance, base.balance.trials, result);
  if (!found) raise_not_found(base.orbit);
  if (!result) raise(NumericalFailure(studies::nothing_followed(*found, over, request, curve), 0.0, {}, 0.0));
  for (const results::NamedBranch& one : found->curves) require_whole(one.branch, found->along, *result);
  return *result;
}

Result continue_orbit(const Scene& scene, const std::string& over, double to, const std::optional<double>& from,
                      const py::kwargs& given) {
  Keywords keywords("continue_orbit", given);
  const Method method = method_of(keywords, scene, {"shooting", "balance"});
  const studies::OrbitSearch& search = method.search;
  studies::ContinuationRequest request;
  keywords.read(request);
  request.to = to;
  request.from = from ? *from : scene::get_continuous_key(scene, over);
  if (request.from == request.to)
    throw InvalidInput(fmt::format("continue_orbit: to = {}: the range has no length", to));
  const std::optional<studies::CurveRequest> curve = curve_request(keywords);
  BranchCertificates own;
  if (method.balances) keywords.read(own);
  const ModelChoice choice(keywords);
  Call call(keywords);
  if (curve) return continue_special(scene, over, method, request, own, *curve, choice, call);
  if (method.balances) return continue_balance(scene, over, method, request, own, choice, call);
  const auto [found, result] = call([&] {
    const auto basis = choice.basis(scene, call.options());
    studies::Continuation continuation = studies::continue_orbit(scene, over, basis, search, request, call.options());
    call.options().check_interrupt();
    std::optional<Result> kept;
    if (continuation.found.converged()) {
      kept.emplace(studies::content_of(studies::Family(scene, {over}, basis), continuation.start,
                                       std::make_shared<const std::vector<results::NamedBranch>>(continuation.branches),
                                       studies::command_of(over, choice.word(), search, request), call.options()));
    }
    return std::pair(std::move(continuation), std::move(kept));
  });
  if (!result) raise_not_found(found.found);
  require_whole(found.branches.front().branch, found.start, *result);
  return *result;
}

Result spectrum(const Result& orbit, const std::vector<int>& dofs, const py::kwargs& given) {
  Keywords keywords("spectrum", given);
  studies::SpectrumRequest request;
  keywords.read(request);
  request.dofs = dofs;
  const ModelChoice choice(keywords);
  Call call(keywords);
  const results::StoreReader reader = orbit.reader();
  return call([&] {
    require_kind(reader, std::array{results::FileKind::kOrbit});
    const Scene scene = results::load_scene_of(reader);
    const studies::Family model(scene, {}, choice.basis(scene, call.options()));
    return Result(studies::content_of(model, studies::orbit_spectrum(model, reader, request), request));
  });
}

struct Comparison {
  bool compare = false;
  static constexpr auto fields() {
    return std::tuple{
        optional("compare", &Comparison::compare, "", "with a reduced model: the full one's too, and both compared")};
  }
};

Result skeleton(const Scene& scene, const py::kwargs& given) {
  Keywords keywords("skeleton", given);
  studies::SkeletonRequest request;
  keywords.read(request);
  Comparison own;
  keywords.read(own);
  const ModelChoice choice(keywords);
  Call call(keywords);
  return call([&] {
    const studies::Family model(scene, {}, choice.basis(scene, call.options()));
    if (!own.compare)
      return Result(studies::content_of(
          model, std::make_shared<const results::ModelSkeleton>(studies::skeleton(model, request, call.options())),
          choice.word(), request));
    if (choice.word() != "rom")
      throw InvalidInput("skeleton: compare = True: a reduced model with the full one; add model, a result of reduce");
    return Result(studies::content_of(model,
                                      std::make_shared<const studies::SkeletonPair>(
                                          studies::skeletons(studies::Family(scene), model, request, call.options())),
                                      choice.word(), request));
  });
}

}  // namespace

void add_orbits(py::module_& module) {
  const std::string search =
      "    start (str | npt.ArrayLike): \"settle\" (a run from [initial]), \"initial\", or displacements and "
      "velocities; of "
      "a\n"
      "        balance \"contact\" (all stops pressing) or \"gap\"\n" +
      model_text() + options_text<studies::OrbitSearch>() +
      "    by (str): \"shooting\" (exact), \"balance\": truncated Fourier series of the contacts, or \"mixed\" "
      "(find_orbit):\n"
      "        contacts in the time domain, the rest in series, and the exact orbit behind: with certify or error\n"
      "        (default \"shooting\")\n" +
      options_text<studies::BalanceWords>();
  module.def("find_orbit", &find_orbit, py::arg("scene"),
             ("A periodic orbit, its multipliers and one period of it; a balance; or a mixed orbit.\n\n" + search +
              call_text())
                 .c_str());
  module.def(
      "continue_orbit", &continue_orbit, py::arg("scene"), py::arg("over"), py::arg("to"),
      py::arg("from_") = py::none(),
      ("Branches of periodic orbits over a key. They begin at the scene's own value of the key where the range\n"
       "holds it, and go both ways; else at `from_`.\n\n"
       "    over: key of the scene, e.g. \"drive.omega\"\n    to: end of the range\n"
       "    from_: its beginning; by default the scene's own value\n"
       "    point (str): a kind of special point, or \"kind:value\" for the one nearest to a value of `over`, to be\n"
       "        followed over a second key too: curves in the plane of both. Kinds:\n"
       "        " +
       fmt::format("{}", fmt::join(studies::followed_words(), ", ")) +
       "\n    along (tuple[str, float, float]): that key, from, to\n" + search + options_text<BranchCertificates>() +
       options_text<studies::ContinuationRequest>() + call_text())
          .c_str());
  module.def("spectrum", &spectrum, py::arg("orbit"), py::arg("dofs") = std::vector<int>{},
             ("Fourier coefficients of an exact orbit: displacement, velocity and force of each contact.\n\n"
              "    orbit: of find_orbit\n    dofs: degrees of freedom, from 1, whose motion is given too\n" +
              model_text() + options_text<studies::SpectrumRequest>() + call_text())
                 .c_str());
  module.def("skeleton", &skeleton, py::arg("scene"),
             ("The unstable periodic orbits of a chaotic motion.\n\n" + model_text() + options_text<Comparison>() +
              options_text<studies::SkeletonRequest>() + call_text())
                 .c_str());
}

}  // namespace slipmode::python
