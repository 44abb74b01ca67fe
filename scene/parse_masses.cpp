#include <slipmode/core/errors.hpp>
#include "scene/internal/scene_parts.hpp"

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
  if (in.has("at")) {
    link.second = static_cast<int>(in.integer("at", 1, masses));
  } else {
    const std::vector<int> ends = in.integers_or("between", {}, 1, masses);
    if (ends.size() != 2 || ends[0] == ends[1]) {
      in.fail("between", "not two different masses", fmt::format("[mass, mass], masses 1 to {}", masses));
    }
    link.first = ends[0];
    link.second = ends[1];
  }
  link.stiffness = in.number_or("stiffness", link.stiffness, kNonNegative);
  link.damping = in.number_or("damping", link.damping, kNonNegative);
  in.finish();
  return link;
}

Eigen::MatrixXd square_or(TomlReader& in, const std::string& key, const Eigen::MatrixXd& otherwise) {
  return in.has(key) ? in.square(key, otherwise.rows()) : otherwise;
}

}  // namespace

fem::MassesOptions read_masses(TomlReader& in, const std::string& units) {
  fem::MassesOptions options;
  options.units = units;
  options.mass =
      in.is_array("mass") ? in.numbers_or("mass", {}, kPositive) : std::vector<double>{in.number("mass", kPositive)};
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
