#include <slipmode/scene/scene_words.hpp>
#include "scene/internal/scene_parts.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::scene {

namespace {

constexpr const char* kShakerOnly = "belongs to a shaker, the drive is a belt";
constexpr const char* kBeltOnly = "belongs to a belt, the drive is a shaker";

/// The words of the bases a structure can have.
std::vector<std::string> basis_words(const Scene& scene) {
  if (scene.beam() != nullptr) return kBases;
  return {kBases.begin(), kBases.begin() + kChainBases};
}

/// Refuses modal functions without sensors.
void check_sensors(TomlReader& in, const std::string& key, BasisChoice basis, const Scene& scene) {
  if (basis != BasisChoice::kPomf || scene.sensors) return;
  in.fail(key, "modal functions are made from sensors and the scene has none", "another basis, or add [sensors]");
}

std::vector<BasisChoice> default_bases(const Scene& scene) {
  if (scene.beam() == nullptr) return {BasisChoice::kPom, BasisChoice::kLnm};
  return {scene.sensors ? BasisChoice::kPomf : BasisChoice::kMassPom, BasisChoice::kLnm, BasisChoice::kLnmStatic};
}

std::vector<BasisChoice> read_bases(TomlReader& in, const Scene& scene) {
  if (!in.has("bases")) return default_bases(scene);
  std::vector<BasisChoice> bases;
  for (const std::size_t word : in.choices("bases", basis_words(scene))) {
    bases.push_back(static_cast<BasisChoice>(word));
    check_sensors(in, "bases", bases.back(), scene);
  }
  return bases;
}

Range read_frequencies(TomlReader& in, const Scene& scene) {
  const Range range = read_range(in.table("frequencies"), kPositive);
  if (!scene.amplitude.covers(range.from, range.to)) {
    in.fail("frequencies",
            fmt::format("the amplitude curve has no value >= 0 everywhere from {} to {} Hz", range.from, range.to),
            "a range the curve of drive.amplitude covers");
  }
  return range;
}

int most_modes(const Scene& scene) {
  return static_cast<int>(std::min<Eigen::Index>(scene.size(), std::numeric_limits<int>::max()));
}

}  // namespace

Range read_range(TomlReader in, const Limits& ends) {
  const Range range{in.number("from", ends), in.number("to", ends), in.number("step", kPositive)};
  in.finish();
  return range;
}

SensorSpec read_sensors(TomlReader in, const Scene& scene) {
  constexpr double kClosest = 1e-9;  // of the reach, as pod::SensorArray
  SensorSpec sensors;
  sensors.kind = kSensors[in.choice("kind", words_of(kSensors))].kind;
  const bool strain = sensors.kind == pod::SensorKind::kStrain;
  const double reach = beam_reach(*scene.beam());
  const double end = strain ? beam_length(*scene.beam()) : reach;
  const std::string valid = strain
                                ? fmt::format("a place on the beam, x >= 0 and <= {} (its length)", end)
                                : fmt::format("a place on the beam, x > 0 and <= {} (the end of the extension)", end);
  if (!in.has("x")) (void)in.number("x", kFinite);
  sensors.x =
      in.numbers_or("x", {}, {.low = 0.0, .high = end * (1.0 + kEndSlack), .above = !strain, .text = valid.c_str()});
  if (sensors.x.empty()) in.fail("x", "no sensors", "at least one place");
  for (std::size_t i = 0; i < sensors.x.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (std::abs(sensors.x[i] - sensors.x[j]) < kClosest * reach) {
        in.fail("x", fmt::format("two sensors at {}", sensors.x[i]), "different places");
      }
    }
  }
  sensors.noise = in.number_or("noise", sensors.noise, kNonNegative);
  sensors.seed = static_cast<std::uint64_t>(in.integer_or("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
  in.finish();
  return sensors;
}

ReductionSpec read_reduction(TomlReader in, const Scene& scene) {
  ReductionSpec reduction;
  reduction.basis = static_cast<BasisChoice>(in.choice_or("basis", 0, basis_words(scene)));
  check_sensors(in, "basis", reduction.basis, scene);
  if (in.has("modes") && in.has("energy")) in.fail("modes", "energy is given too", "either modes or energy");
  reduction.choice.modes = in.integer_or("modes", 0, 1, most_modes(scene));
  reduction.choice.energy = in.number_or("energy", reduction.choice.energy,
                                         {.low = 0.0, .high = 1.0, .above = true, .text = "a share > 0 and <= 1"});
  if (!scene.sensors) {
    for (const char* key : {"fit", "functions"}) {
      in.refuse(key, "belongs to modal functions from sensors and the scene has none", "add [sensors]");
    }
    in.finish();
    return reduction;
  }
  const auto sensors = static_cast<std::int64_t>(scene.sensors->x.size());
  const std::int64_t functions = in.integer_or("functions", 0, 1, kMostCount);
  if (functions > sensors) {
    in.fail("functions", fmt::format("more modal functions than {} sensors can tell apart", sensors),
            fmt::format("1 to {}, or more sensors", sensors));
  }
  reduction.functions = static_cast<int>(functions);
  reduction.fit = kFits[in.choice_or("fit", 0, words_of(kFits))].family;
  const std::int64_t carriers = functions > 0 ? functions : sensors;
  if (reduction.basis == BasisChoice::kPomf && reduction.choice.modes > carriers) {
    in.fail("modes", fmt::format("more than the {} modal functions that carry them", carriers),
            fmt::format("1 to {}", carriers));
  }
  in.finish();
  return reduction;
}

ValidationSpec read_validation(TomlReader in, const Scene& scene) {
  for (const char* key : {"frequencies", "cycles", "kept", "gauge", "bases", "follow", "cost_cycles"}) {
    in.refuse(key, kShakerOnly, "drive.kind = \"shaker\" with it");
  }
  ValidationSpec spec;
  if (in.has("speeds")) spec.speeds = read_range(in.table("speeds"), kFinite);
  spec.segments = static_cast<int>(in.integer_or("segments", spec.segments, 1, kMostCount));
  spec.transient = in.number_or("transient", spec.transient, kNonNegative);
  spec.block = in.number_or("block", spec.block, kPositive);
  spec.limit = in.number_or("limit", std::max(spec.limit, spec.block), kPositive);
  if (!in.has("block")) spec.block = std::min(spec.block, spec.limit);
  if (spec.limit < spec.block) in.fail("limit", "shorter than one block", fmt::format(">= block = {}", spec.block));
  spec.sweep_limit = in.number_or("sweep_limit", spec.sweep_limit, kPositive);
  spec.period_tolerance = in.number_or("period_tolerance", spec.period_tolerance, kPositive);
  spec.max_period = static_cast<int>(in.integer_or("max_period", spec.max_period, 1, kMostCount));
  spec.horizon = in.number_or("horizon", spec.horizon, kPositive);
  spec.horizon_starts = static_cast<int>(in.integer_or("horizon_starts", spec.horizon_starts, 1, kMostCount));
  spec.orbits = in.numbers_or("orbits", {}, kFinite);
  spec.orbit_tolerance = in.number_or("orbit_tolerance", spec.orbit_tolerance, kPositive);
  spec.modes = in.integers_or("modes", {}, 1, most_modes(scene));
  spec.lyapunov_duration = in.number_or("lyapunov_duration", spec.lyapunov_duration, kPositive);
  spec.cost_duration = in.number_or("cost_duration", spec.cost_duration, kNonNegative);
  spec.cost_repeats = static_cast<int>(in.integer_or("cost_repeats", spec.cost_repeats, 1, kMostCount));
  in.finish();
  return spec;
}

ShakenValidationSpec read_shaken_validation(TomlReader in, const Scene& scene) {
  for (const char* key : {"speeds", "segments", "transient", "block", "limit", "sweep_limit", "horizon",
                          "horizon_starts", "orbits", "orbit_tolerance", "lyapunov_duration", "cost_duration"}) {
    in.refuse(key, kBeltOnly, "drive.kind = \"belt\" with it");
  }
  ShakenValidationSpec spec;
  if (in.has("frequencies")) spec.frequencies = read_frequencies(in, scene);
  spec.cycles = in.number_or("cycles", spec.cycles, kPositive);
  spec.kept = in.number_or("kept", std::min(spec.kept, spec.cycles), kPositive);
  if (spec.kept > spec.cycles) in.fail("kept", "more than are run", fmt::format("at most cycles = {}", spec.cycles));
  if (const fem::BeamOptions* beam = scene.beam(); beam != nullptr && in.has("gauge")) {
    const double length = beam_length(*beam);
    const std::string valid = fmt::format("a place on the beam, x >= 0 and <= {} (its length)", length);
    spec.gauge = in.number("gauge", {.low = 0.0, .high = length * (1.0 + kEndSlack), .text = valid.c_str()});
  }
  spec.modes = in.integers_or("modes", {}, 1, most_modes(scene));
  spec.bases = read_bases(in, scene);
  spec.follow = kFollows[in.choice_or("follow", 0, words_of(kFollows))].follow;
  spec.period_tolerance = in.number_or("period_tolerance", spec.period_tolerance, kPositive);
  spec.max_period = static_cast<int>(in.integer_or("max_period", spec.max_period, 1, kMostCount));
  spec.cost_cycles = in.number_or("cost_cycles", spec.cost_cycles, kNonNegative);
  spec.cost_repeats = static_cast<int>(in.integer_or("cost_repeats", spec.cost_repeats, 1, kMostCount));
  in.finish();
  return spec;
}

}  // namespace slipmode::scene
