#include <slipmode/studies/sweep.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/driven_store.hpp>
#include <slipmode/scene/driven.hpp>
#include <slipmode/scene/solver_options.hpp>

#include <utility>

namespace slipmode::studies {
namespace {

SweepMode mode_of(const SweepOptions& options) { return options.follow ? SweepMode::kFollow : SweepMode::kIndependent; }

void sweep_belt(const Family& family, const SweepOptions& options, const RunOptions& run, Sweep& out) {
  diagnostics::SweepOptions belt{.mode = mode_of(options),
                                 .segments = options.segments,
                                 .settle = scene::sweep_settle_options(family.scene()),
                                 .parallel = run.parallel("sweep")};
  if (options.journal != nullptr) belt.sink = results::journal_sink(*options.journal);
  diagnostics::SweepResult result = diagnostics::sweep(family.model(), out.values, family.start(), belt);
  out.belt = std::move(result.points);
  out.interrupted = result.interrupted;
}

void sweep_driven(const Family& family, const SweepOptions& options, const RunOptions& run, Sweep& out) {
  diagnostics::DrivenSweepOptions driven{.mode = mode_of(options),
                                         .segments = options.segments,
                                         .driven = scene::driven_options(family.scene()),
                                         .parallel = run.parallel("sweep")};
  driven.driven.exponent_cycles = options.exponent_cycles;
  if (options.journal != nullptr) driven.sink = results::driven_journal_sink(*options.journal);
  const auto pass = [&](const std::vector<double>& values, int tag) {
    if (out.interrupted) return std::vector<diagnostics::DrivenPoint>();
    driven.model = tag;
    driven.sink.first_piece = tag == 1 && options.both ? sweep_pieces(values.size(), driven.mode, driven.segments) : 0;
    diagnostics::DrivenSweep one = diagnostics::driven_sweep(family.driven_model(), values, family.start(), driven);
    out.interrupted = one.interrupted;
    return std::move(one.points);
  };
  if (!options.reverse) out.up = pass(out.values, 0);
  if (options.reverse || options.both) out.down = pass({out.values.rbegin(), out.values.rend()}, 1);
}

}  // namespace

void check(const scene::Scene& scene, const SweepOptions& options) {
  if (!is_driven(scene) && (options.reverse || options.both || options.exponent_cycles != 0.0)) {
    throw InvalidInput(
        "--reverse, --both and --lyapunov are for scenes with a shaker or a force; a belt's sweep runs from FROM to "
        "TO");
  }
  if (options.both && !options.follow) {
    throw InvalidInput("--both: without --follow every value starts alike, and up and down are the same; add --follow");
  }
}

Pieces pieces(const std::vector<double>& values, const SweepOptions& options) {
  const std::size_t of_pass = sweep_pieces(values.size(), mode_of(options), options.segments);
  const std::size_t count = options.both ? 2 * of_pass : of_pass;
  return options.follow ? chains(count, "with --segments, or without --follow") : Pieces{count, "values"};
}

std::string command_of(const Over& over, const std::string& model, const SweepOptions& options) {
  SweepOptions said = options;
  if (!said.follow) said.segments = SweepOptions().segments;  // they decide nothing then
  return command_text("sweep", {over}, model_option(model) + options_text(said));
}

Sweep sweep(const Family& family, const std::vector<double>& values, const SweepOptions& options,
            const RunOptions& run) {
  check(family.scene(), options);
  Sweep out;
  out.values = values;
  if (is_driven(family.scene())) {
    sweep_driven(family, options, run, out);
  } else {
    sweep_belt(family, options, run, out);
  }
  return out;
}

void store(results::StoreWriter& writer, const Family& family, const Sweep& sweep) {
  const scene::Scene& scene = family.scene();
  const results::Units units = results::Units::of(scene.units);
  const std::string group = family.basis() ? "sweep/reduced" : "sweep/full";
  if (!is_driven(scene)) {
    results::store_sweep(writer, group, family.title(), family.axis(), units, sweep.belt);
    return;
  }
  const results::DrivenAxes axes{family.axis(), scene::reading_name(scene), scene::reading_unit(scene)};
  const std::string upward = sweep.down.empty() ? family.title() : family.title() + ", upward";
  if (!sweep.up.empty()) results::store_driven(writer, group, upward, axes, units, sweep.up);
  if (!sweep.down.empty())
    results::store_driven(writer, group + "_reverse", family.title() + ", downward", axes, units, sweep.down);
}

}  // namespace slipmode::studies
