#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/advice.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/trade_off.hpp>
#include "python/call.hpp"
#include "python/module.hpp"
#include "python/result.hpp"

#include <memory>
#include <utility>

namespace slipmode::python {
namespace {

using scene::Scene;

Result trade_off(const Scene& given_scene, const py::kwargs& given) {
  Keywords keywords("trade", given);
  studies::TradeWords words;
  keywords.read(words);
  const std::string output = keywords.output();
  Call call(keywords);
  return call([&] {
    const Scene scene = scene::with_own_times(given_scene);
    const studies::TradeRequest request = studies::trade_request(words, scene);
    const studies::TradePlan plan = studies::trade_plan(scene, request, call.options());
    studies::ResultFile file(output, scene, results::FileKind::kTrade, studies::command_of(request),
                             studies::identity_of(request), {}, {}, studies::Unfinished::kKept);
    const auto done = std::make_shared<const studies::TradeFound>(
        studies::trade_off(scene, request, plan, call.options(), file.journal()));
    return Result(file.finish(
        [scene, request, done](results::StoreWriter& writer) { studies::store(writer, scene, request, *done); }));
  });
}

Result advise(const Scene& given_scene, const py::kwargs& given) {
  Keywords keywords("advise", given);
  studies::AdviceWords words;
  keywords.read(words);
  const std::string output = keywords.output();
  Call call(keywords);
  return call([&] {
    const Scene scene = scene::with_own_times(given_scene);
    const studies::AdviceRequest request = studies::advice_request(words);
    std::vector<trade::Effect> effects = trade::effects_of(scene);
    studies::ResultFile file(output, scene, results::FileKind::kTrade, studies::command_of(request),
                             studies::identity_of(request), {}, {}, studies::Unfinished::kKept);
    const auto done = std::make_shared<const studies::Advice>(
        studies::advise(scene, std::move(effects), request, call.options(), file.journal()));
    return Result(file.finish([scene, done](results::StoreWriter& writer) { studies::store(writer, scene, *done); }));
  });
}

}  // namespace

void add_trades(py::module_& module) {
  const std::string output =
      "    output (str): result file; an interrupted call goes on from there, one without from the user's cache\n";
  module.def("trade", &trade_off, py::arg("scene"),
             ("Speed against accuracy: what is how wrong, and how costly. rows are the configurations, the reference\n"
              "first; chosen is the scene of what error or budget picked.\n\n" +
              output + options_text<studies::TradeWords>() + call_text())
                 .c_str());
  module.def("advise", &advise, py::arg("scene"),
             ("What a scene requires, and what it can do without. rows are its effects, each with a verdict; lean is\n"
              "the scene with only what it requires.\n\n" +
              output + options_text<studies::AdviceWords>() + call_text())
                 .c_str());
}

}  // namespace slipmode::python
