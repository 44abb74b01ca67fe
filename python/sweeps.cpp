#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/basins.hpp>
#include <slipmode/studies/orbit_map.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/sweep.hpp>
#include "python/call.hpp"
#include "python/model.hpp"
#include "python/module.hpp"
#include "python/result.hpp"

#include <pybind11/stl.h>

#include <utility>

namespace slipmode::python {
namespace {

using scene::Scene;
/// A key and its values, as Python gives them.
using Pair = std::pair<std::string, std::vector<double>>;

studies::Over over_of(const Pair& pair) { return {pair.first, pair.second}; }

Result sweep(const Scene& given_scene, const std::string& over, const std::vector<double>& values,
             const py::kwargs& given) {
  Keywords keywords("sweep", given);
  studies::SweepOptions options;
  keywords.read(options);
  const ModelChoice choice(keywords);
  const std::string output = keywords.output();
  Call call(keywords);
  return call([&] {
    const Scene scene = scene::with_own_times(given_scene);
    studies::check(scene, options);
    const auto basis = choice.basis(scene, call.options());
    const studies::Family family(scene, {over}, basis);
    studies::check_values(scene, over, values);
    studies::ResultFile file(output, scene, results::FileKind::kSweep,
                             studies::command_of({over, values}, choice.word(), options),
                             basis ? studies::identity_of(basis->basis) : "full");
    options.journal = file.journal();
    auto done = std::make_shared<const studies::Sweep>(studies::sweep(family, values, options, call.options()));
    if (done->interrupted) throw Interrupted();
    return Result(file.finish([family, done](results::StoreWriter& writer) { studies::store(writer, family, *done); }));
  });
}

Result basins(const Scene& scene, const Pair& across, const Pair& up, const std::optional<Pair>& along,
              const py::kwargs& given) {
  Keywords keywords("basins", given);
  studies::BasinsOptions options;
  keywords.read(options);
  const std::string output = keywords.output();
  Call call(keywords);
  return call([&] {
    studies::BasinsRequest request{.over = {over_of(across), over_of(up)}};
    std::vector<std::string> keys;
    if (along) {
      keys.push_back(along->first);
      request.along = along->second;
    }
    const studies::Family family(scene, keys);
    studies::check(family, request);
    if (along) studies::check_values(scene, along->first, along->second);
    studies::ResultFile file(output, scene, results::FileKind::kBasins, studies::command_of(family, request, options));
    options.journal = file.journal();
    auto done = std::make_shared<const studies::BasinsStudy>(studies::basins(family, request, options, call.options()));
    if (done->interrupted) throw Interrupted();
    return Result(file.finish(
        [family, request, done](results::StoreWriter& writer) { studies::store(writer, family, request, *done); }));
  });
}

Result orbit_map(const Scene& scene, const std::vector<Pair>& given_over, const std::vector<std::string>& starts,
                 const py::kwargs& given) {
  Keywords keywords("orbit_map", given);
  studies::OrbitMapOptions options{.starts = starts};
  keywords.read(options);
  const std::string output = keywords.output();
  Call call(keywords);
  return call([&] {
    std::vector<studies::Over> over;
    std::vector<std::string> keys;
    std::vector<std::vector<double>> values;
    for (const auto& [key, own] : given_over) {
      over.push_back({key, own});
      keys.push_back(key);
      values.push_back(own);
    }
    const studies::Family family(scene, keys);
    studies::check(family, options);
    for (const studies::Over& one : over) studies::check_values(scene, one.key, one.values);
    studies::ResultFile file(output, scene, keys.size() > 1 ? results::FileKind::kMap : results::FileKind::kStrobe,
                             studies::command_of(over, options));
    options.journal = file.journal();
    auto done =
        std::make_shared<const studies::OrbitMapStudy>(studies::orbit_map(family, values, options, call.options()));
    if (done->interrupted) throw Interrupted();
    return Result(file.finish([family, done](results::StoreWriter& writer) { studies::store(writer, family, *done); }));
  });
}

}  // namespace

void add_sweeps(py::module_& module) {
  module.def(
      "values", &diagnostics::sweep_values, py::arg("start"), py::arg("stop"), py::arg("step"),
      "Values of a range, both ends included: to the last bit those of the executable's START:STOP:STEP, so that\n"
      "a study begun by one goes on in the other.");
  const std::string output = "    output (str): result file; an interrupted call goes on from there\n";
  module.def("sweep", &sweep, py::arg("scene"), py::arg("over"), py::arg("values"),
             ("Settled motion over values of a key.\n\n    over: key of the scene, e.g. \"drive.speed\"\n" +
              model_text() + output + options_text<studies::SweepOptions>() + call_text())
                 .c_str());
  module.def(
      "basins", &basins, py::arg("scene"), py::arg("across"), py::arg("up"), py::arg("along") = py::none(),
      ("Which attractor each start of a plane ends on.\n\n"
       "    across, up: (key, values) of the start, e.g. (\"initial.displacement.0\", numpy.linspace(-2, 2, 101))\n"
       "    along: (key, values) of the scene: shares at each of them too\n" +
       output + options_text<studies::BasinsOptions>() + call_text())
          .c_str());
  module.def("orbit_map", &orbit_map, py::arg("scene"), py::arg("over"),
             py::arg("starts") = std::vector<std::string>{"scene"},
             ("Settled motion of a driven scene over one key or two.\n\n    over: (key, values), one or two\n"
              "    starts: \"scene\" (its [initial]), \"centre\" (the steady linear motion in the gap)\n" +
              output + options_text<studies::OrbitMapOptions>() + call_text())
                 .c_str());
}

}  // namespace slipmode::python
