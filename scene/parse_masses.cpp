#include <slipmode/core/errors.hpp>
#include "scene/internal/scene_parts.hpp"
#include "scene/internal/toml_fields.hpp"

#include <fmt/format.h>

namespace slipmode::scene {

namespace {

fem::Link read_link(TomlReader& in, int masses) {
  fem::Link link;
  if (in.has("at") == in.has("between")) {
    in.fail(
        in.has("at") ? "between" : "at", in.has("at") ? "at is given too" : "missing",
        fmt::format("either at = mass (the other end is ground) or between = [mass, mass], masses 1 to {}", masses));
  }
  const Limits mass{.low = 1.0, .high = static_cast<double>(masses)};
  if (in.has("at")) {
    link.second = in.integer<int>("at", mass);
  } else {
    const std::vector<int> ends = in.integers("between", mass);
    if (ends.size() != 2 || ends[0] == ends[1]) {
      in.fail("between", "not two different masses", fmt::format("[mass, mass], masses 1 to {}", masses));
    }
    link.first = ends[0];
    link.second = ends[1];
  }
  return read_table(in, link);
}

Eigen::MatrixXd square_or(TomlReader& in, const std::string& key, const Eigen::MatrixXd& otherwise) {
  return in.has(key) ? in.square(key, otherwise.rows()) : otherwise;
}

}  // namespace

fem::MassesOptions read_masses(TomlReader& in, const std::string& units) {
  fem::MassesOptions options;
  options.units = units;
  read_fields(in, options);
  if (options.mass.empty()) in.fail("mass", "no masses", "one number > 0 per mass");
  if (in.has("link")) {
    for (TomlReader& table : in.tables("link")) {
      options.links.push_back(read_link(table, static_cast<int>(options.mass.size())));
    }
  }
  in.finish();
  return options;
}

MatricesSpec read_matrices(TomlReader& in, const std::string& units) {
  MatricesSpec spec;
  spec.units = units;
  spec.mass = in.square("mass");
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(spec.mass.rows(), spec.mass.cols());
  spec.damping = square_or(in, "damping", zero);
  spec.stiffness = square_or(in, "stiffness", zero);
  try {
    (void)structure_of(spec);
  } catch (const InvalidInput& error) {
    in.fail("mass", error.what(),
            "mass symmetric positive definite, stiffness symmetric, the symmetric part of damping positive "
            "semi-definite");
  }
  in.finish();
  return spec;
}

fem::Structure structure_of(const MatricesSpec& spec) {
  return {spec.mass, spec.damping, spec.stiffness, {}, spec.units};
}

}  // namespace slipmode::scene
