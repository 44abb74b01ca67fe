#include <slipmode/core/overloaded.hpp>
#include "scene/internal/toml_fields.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <array>

namespace slipmode::scene {

namespace {

std::string belt_toml(const friction::Belt& belt) {
  const bool ramp = belt.ramp_end > belt.ramp_begin;
  return fmt::format("\n[drive]\nkind = \"belt\"\nspeed = {}\n", ramp ? inline_table(belt) : number_text(belt.speed));
}

std::string force_place_toml(const ForcePlace& place) {
  if (const auto* at = std::get_if<ContactPlace>(&place)) return place_toml(*at);
  return fmt::format("direction = {}\n", value_toml(std::get<1>(place)));
}

std::string force_toml(const ForceSpec& force) {
  const ForceSpec::Harmonic& first = force.harmonics.front();
  std::string out = "\n[drive]\nkind = \"force\"\n";
  out += force.frequency_hz ? number_line("frequency", *force.frequency_hz) : number_line("omega", force.omega);
  out += lines_toml(first, {"order"}) + force_place_toml(first.at);
  const double* mean = std::get_if<double>(&force.mean);
  out += fmt::format("mean = {}\n", mean != nullptr ? number_text(*mean) : value_toml(std::get<1>(force.mean)));
  for (std::size_t k = 1; k < force.harmonics.size(); ++k) {
    const ForceSpec::Harmonic& own = force.harmonics[k];
    out += "\n[[drive.harmonic]]\n" + lines_toml(own) + force_place_toml(own.at);
  }
  return out;
}

std::string amplitude_toml(const friction::AmplitudeCurve& curve) {
  using Curve = friction::AmplitudeCurve;
  return std::visit(Overloaded{[](const Curve::Constant& constant) { return number_text(constant.amplitude); },
                               [](const Curve::Polynomial& polynomial) {
                                 return fmt::format("{{ polynomial = {} }}", value_toml(polynomial.coefficients));
                               },
                               [](const Curve::Table& table) {
                                 std::vector<std::string> points;
                                 for (const auto& [f, amplitude] : table.points)
                                   points.push_back(value_toml(std::array{f, amplitude}));
                                 return fmt::format("{{ table = [{}] }}", fmt::join(points, ", "));
                               },
                               [](const Curve::Exponential& exponential) {
                                 return fmt::format("{{ exponential = {} }}", inline_table(exponential));
                               }},
                    curve.kind);
}

}  // namespace

std::string place_toml(const ContactPlace& place) {
  return std::visit(
      Overloaded{[](int mass) { return fmt::format("at = {}\n", mass); }, [](double x) { return number_line("at", x); },
                 [](AtTip) { return std::string("at = \"tip\"\n"); },
                 [](const Between& pair) { return fmt::format("between = [{}, {}]\n", pair.first, pair.second); }},
      place);
}

std::string drive_toml(const Scene& scene) {
  if (const friction::Belt* belt = scene.drive.belt()) return belt_toml(*belt);
  if (scene.force) return force_toml(*scene.force);
  const friction::Shaker& shaker = *scene.drive.shaker();
  return "\n[drive]\nkind = \"shaker\"\n" + lines_toml(shaker, {"amplitude"}) +
         fmt::format("amplitude = {}\n", amplitude_toml(scene.amplitude));
}

}  // namespace slipmode::scene
