#include <slipmode/scene/scene_words.hpp>
#include "scene/internal/scene_parts.hpp"

#include <fmt/format.h>
#include <array>

namespace slipmode::scene {

namespace {

struct Coefficients {
  double mu_s, mu_k;
};

Coefficients read_coefficients(TomlReader& in) {
  const double mu_k = in.number("mu_k", kNonNegative);
  const double mu_s = in.number("mu_s", kNonNegative);
  if (mu_s < mu_k) in.fail("mu_s", fmt::format("less than mu_k = {}", mu_k), fmt::format("mu_s >= {}", mu_k));
  return {mu_s, mu_k};
}

friction::Law read_coulomb(TomlReader& in) {
  const auto [mu_s, mu_k] = read_coefficients(in);
  in.refuse("alpha", "law \"coulomb\" does not depend on the sliding speed", "no alpha");
  in.refuse("stiffness", "law \"coulomb\" is rigid", "no stiffness, or law = \"compliant\"");
  return friction::Coulomb{mu_s, mu_k};
}

friction::Law read_stribeck(TomlReader& in) {
  const auto [mu_s, mu_k] = read_coefficients(in);
  return friction::Stribeck{mu_s, mu_k, in.number("alpha", kNonNegative)};
}

friction::Law read_tanh(TomlReader& in) {
  const auto [mu_s, mu_k] = read_coefficients(in);
  friction::TanhRegularised tanh{mu_s, mu_k};
  tanh.alpha = in.number_or("alpha", tanh.alpha, kNonNegative);
  tanh.epsilon = in.number_or("epsilon", tanh.epsilon, kPositive);
  return tanh;
}

friction::Law read_compliant(TomlReader& in) {
  const auto [mu_s, mu_k] = read_coefficients(in);
  return friction::CompliantCoulomb{mu_s, mu_k, in.number("stiffness", kPositive)};
}

friction::Law read_dahl(TomlReader& in) {
  for (const char* key : {"mu_s", "mu_k"}) {
    in.refuse(key, "law \"dahl\" does not tell static from sliding friction", "mu");
  }
  const double mu = in.number("mu", kPositive);
  return friction::Dahl{mu, in.number("stiffness", kPositive)};
}

friction::Law read_lugre(TomlReader& in) {
  const auto [mu_s, mu_k] = read_coefficients(in);
  if (mu_k == 0.0) in.fail("mu_k", "impossible value with law \"lugre\"", "a number > 0");
  friction::LuGre lugre{mu_s, mu_k};
  lugre.stribeck_speed = in.number("stribeck_speed", kPositive);
  lugre.stiffness = in.number("stiffness", kPositive);
  lugre.damping = in.number_or("damping", lugre.damping, kNonNegative);
  lugre.viscous = in.number_or("viscous", lugre.viscous, kNonNegative);
  return lugre;
}

/// One stop; what it does not say is taken from `otherwise`, when there is one.
friction::Stop read_stop(TomlReader in, const std::optional<friction::Stop>& otherwise) {
  const friction::Stop given = otherwise.value_or(friction::Stop{});
  friction::Stop stop;
  stop.stiffness =
      otherwise ? in.number_or("stiffness", given.stiffness, kPositive) : in.number("stiffness", kPositive);
  stop.damping = in.number_or("damping", given.damping, kNonNegative);
  stop.gap = otherwise ? in.number_or("gap", given.gap, kFinite) : in.number("gap", kFinite);
  in.finish();
  return stop;
}

friction::Law read_clearance(TomlReader& in) {
  for (const char* key : {"normal_load", "mu_s", "mu_k", "mu", "alpha", "tilt_deg"}) {
    in.refuse(key, "a clearance has no friction", "stop, or left and right, each { stiffness, damping, gap }");
  }
  friction::Clearance law;
  if (in.has("stop")) {
    law.left = law.right = read_stop(in.table("stop"), std::nullopt);
  } else if (!in.has("left") && !in.has("right")) {
    (void)in.table("stop");  // missing
  }
  if (in.has("left")) law.left = read_stop(in.table("left"), law.left);
  if (in.has("right")) law.right = read_stop(in.table("right"), law.right);
  law.loss = static_cast<friction::ContactLoss>(in.choice_or("loss", 0, kLosses));
  if (law.left && law.right && law.left->gap + law.right->gap < 0.0) {
    in.fail("law", fmt::format("the stops overlap: gaps {} and {}", law.left->gap, law.right->gap),
            "gaps whose sum is >= 0");
  }
  return law;
}

}  // namespace

friction::Law read_law(TomlReader& in) {
  using Read = friction::Law (*)(TomlReader&);
  constexpr std::array<Read, 7> kRead = {read_coulomb, read_stribeck, read_tanh,     read_compliant,
                                         read_dahl,    read_lugre,    read_clearance};  // in the order of kLaws
  return kRead[in.choice("law", kLaws)](in);
}

}  // namespace slipmode::scene
