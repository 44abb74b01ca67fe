#include "scene/internal/scene_parts.hpp"
#include "scene/internal/scene_words.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::scene {

namespace {

constexpr const char* kShakerOnly = "belongs to a shaker or a force, the drive is a belt";
constexpr const char* kBeltOnly = "belongs to a belt, the drive has a period";

/// The words of the bases a structure can have.
std::vector<std::string> basis_words(const Scene& scene) {
  std::vector<std::string> all = words<BasisChoice>();
  if (scene.beam() == nullptr) all.resize(kChainBases);
  return all;
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

/// Of sizes of reduced models: at most the structure's.
Limits mode_limits(const Scene& scene) { return {.low = 1.0, .high = static_cast<double>(scene.size())}; }

/// A place on a beam from 0 to `end`, `valid` in words; the clamp only when it is not `above`.
Limits beam_limits(double end, const std::string& valid, bool above = false) {
  return {.low = 0.0, .high = end * (1.0 + kEndSlack), .above = above, .text = valid.c_str()};
}

/// Every value of a sweep must be one the drive can have.
void check_sweep(TomlReader& in, const DrivenValidationSpec& spec, const Scene& scene) {
  const auto& swept = spec.frequencies;
  if (scene.force || !swept || scene.amplitude.covers(swept->from, swept->to)) return;
  in.fail("frequencies",
          fmt::format("the amplitude curve has no value >= 0 everywhere from {} to {} Hz", swept->from, swept->to),
          "a range the curve of drive.amplitude covers");
}

}  // namespace

Without without_in_validation(const Scene& scene) {
  Without absent = values_of_other_drives(scene);
  if (scene.force) absent.emplace_back("bases");  // those of [reduction] and natural modes are compared
  if (scene.beam() == nullptr) absent.emplace_back("gauge");
  return absent;
}

SensorSpec read_sensors(TomlReader in, const Scene& scene) {
  constexpr double kClosest = 1e-9;  // of the reach, as pod::SensorArray
  SensorSpec sensors;
  const double reach = beam_reach(*scene.beam()), length = beam_length(*scene.beam());
  std::string valid;
  read_fields(in, sensors, {.limits = [&](std::string_view key, const Limits& own) {
                if (key != "x") return own;
                const bool strain = sensors.kind == pod::SensorKind::kStrain;
                valid = strain ? fmt::format("a place on the beam, x >= 0 and <= {} (its length)", length)
                               : fmt::format("a place on the beam, x > 0 and <= {} (the end of the extension)", reach);
                return beam_limits(strain ? length : reach, valid, !strain);
              }});
  if (sensors.x.empty()) in.fail("x", "no sensors", "at least one place");
  for (std::size_t i = 0; i < sensors.x.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (std::abs(sensors.x[i] - sensors.x[j]) < kClosest * reach) {
        in.fail("x", fmt::format("two sensors at {}", sensors.x[i]), "different places");
      }
    }
  }
  in.finish();
  return sensors;
}

ReductionSpec read_reduction(TomlReader in, const Scene& scene) {
  ReductionSpec reduction;
  reduction.basis = static_cast<BasisChoice>(in.choice_or("basis", 0, basis_words(scene)));
  check_sensors(in, "basis", reduction.basis, scene);
  if (in.has("modes") && in.has("energy"))
    in.fail("modes", "energy is given too", "either modes or energy; --set reduction={modes=2} replaces both");
  read_fields(in, reduction.choice, {.limits = [&](std::string_view key, const Limits& own) {
                return key == "modes" ? mode_limits(scene) : own;
              }});
  if (!scene.sensors) {
    for (const char* key : {"fit", "functions"}) {
      in.refuse(key, "belongs to modal functions from sensors and the scene has none", "add [sensors]");
    }
    in.finish();
    return reduction;
  }
  const auto sensors = static_cast<std::int64_t>(scene.sensors->x.size());
  read_fields(in, reduction, {.without = {"basis"}});
  if (reduction.functions > sensors) {
    in.fail("functions", fmt::format("more modal functions than {} sensors can tell apart", sensors),
            fmt::format("1 to {}, or more sensors", sensors));
  }
  const std::int64_t carriers = reduction.functions > 0 ? reduction.functions : sensors;
  if (reduction.basis == BasisChoice::kPomf && reduction.choice.modes > carriers) {
    in.fail("modes", fmt::format("more than the {} modal functions that carry them", carriers),
            fmt::format("1 to {}", carriers));
  }
  in.finish();
  return reduction;
}

ValidationSpec read_validation(TomlReader in, const Scene& scene) {
  refuse_others<DrivenValidationSpec, ValidationSpec>(in, kShakerOnly, "drive.kind = \"shaker\" or \"force\" with it");
  ValidationSpec spec;
  read_fields(in, spec, {.limits = [&](std::string_view key, const Limits& own) {
                return key == "modes" ? mode_limits(scene) : own;
              }});
  if (!in.has("limit")) spec.limit = std::max(spec.limit, spec.block);
  if (!in.has("block")) spec.block = std::min(spec.block, spec.limit);
  if (spec.limit < spec.block) in.fail("limit", "shorter than one block", fmt::format(">= block = {}", spec.block));
  in.finish();
  return spec;
}

DrivenValidationSpec read_driven_validation(TomlReader in, const Scene& scene) {
  refuse_others<ValidationSpec, DrivenValidationSpec>(in, kBeltOnly, "drive.kind = \"belt\" with it");
  refuse_values_of_other_drives(in, scene);
  if (scene.force)
    in.refuse("bases", "belongs to a shaker, the drive is a force",
              "no such key; POMs, LNMs, and LNMs with static modes are compared");
  DrivenValidationSpec spec;
  const double length = scene.beam() != nullptr ? beam_length(*scene.beam()) : 0.0;
  const std::string valid = fmt::format("a place on the beam, x >= 0 and <= {} (its length)", length);
  Without absent = without_in_validation(scene);
  absent.emplace_back("bases");  // read below, as what a scene without them has
  read_fields(in, spec,
              {.without = absent, .limits = [&](std::string_view key, const Limits& own) {
                 return key == "modes" ? mode_limits(scene) : key == "gauge" ? beam_limits(length, valid) : own;
               }});
  check_sweep(in, spec, scene);
  if (!in.has("kept")) spec.kept = std::min(spec.kept, spec.cycles);
  if (spec.kept > spec.cycles) in.fail("kept", "more than are run", fmt::format("at most cycles = {}", spec.cycles));
  if (!scene.force) spec.bases = read_bases(in, scene);
  in.finish();
  return spec;
}

}  // namespace slipmode::scene
