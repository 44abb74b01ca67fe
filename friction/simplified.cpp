#include <slipmode/friction/simplified.hpp>

#include <slipmode/core/overloaded.hpp>

namespace slipmode::friction {

namespace {

using Other = std::optional<Law>;

Other nothing(const auto& /*law*/) { return std::nullopt; }

}  // namespace

std::optional<Law> rigid(const Law& law) {
  return std::visit(Overloaded{[](const CompliantCoulomb& spring) -> Other {
                                 return Coulomb{spring.mu_s, spring.mu_k};
                               },
                               [](const Dahl& dahl) -> Other {
                                 return Coulomb{dahl.mu, dahl.mu};
                               },
                               [](const LuGre& lugre) -> Other {
                                 return Stribeck{lugre.mu_s, lugre.mu_k, 1.0 / lugre.stribeck_speed};
                               },
                               [](const TanhRegularised& smooth) -> Other {
                                 if (smooth.alpha == 0.0) return Coulomb{smooth.mu_s, smooth.mu_s};
                                 return Stribeck{smooth.mu_s, smooth.mu_k, smooth.alpha};
                               },
                               [](const auto& any) { return nothing(any); }},
                    law);
}

std::optional<Law> regularised(const Law& law, double epsilon) {
  constexpr double kDecay = 0.1;  // of a static peak, over 1/ε
  const auto from_coulomb = [epsilon](double mu_s, double mu_k) -> Other {
    return TanhRegularised{mu_s, mu_k, mu_s > mu_k ? kDecay / epsilon : 0.0, epsilon};
  };
  return std::visit(Overloaded{[&](const Coulomb& coulomb) { return from_coulomb(coulomb.mu_s, coulomb.mu_k); },
                               [&](const CompliantCoulomb& spring) { return from_coulomb(spring.mu_s, spring.mu_k); },
                               [&](const Stribeck& stribeck) -> Other {
                                 return TanhRegularised{stribeck.mu_s, stribeck.mu_k, stribeck.alpha, epsilon};
                               },
                               [&](const TanhRegularised& smooth) -> Other {
                                 if (smooth.epsilon == epsilon) return std::nullopt;
                                 return TanhRegularised{smooth.mu_s, smooth.mu_k, smooth.alpha, epsilon};
                               },
                               [](const auto& any) { return nothing(any); }},
                    law);
}

std::optional<Law> with_spring(const Law& law, double stiffness, double factor) {
  return std::visit(Overloaded{[&](const CompliantCoulomb& spring) -> Other {
                                 return CompliantCoulomb{spring.mu_s, spring.mu_k, factor * spring.stiffness};
                               },
                               [&](const Coulomb& coulomb) -> Other {
                                 if (!(stiffness > 0.0)) return std::nullopt;
                                 return CompliantCoulomb{coulomb.mu_s, coulomb.mu_k, factor * stiffness};
                               },
                               [](const auto& any) { return nothing(any); }},
                    law);
}

std::optional<Law> without_static_peak(const Law& law) {
  return std::visit(
      [](auto own) -> Other {
        if constexpr (requires { own.mu_s > own.mu_k; }) {
          if (!(own.mu_s > own.mu_k)) return std::nullopt;
          own.mu_s = own.mu_k;
          return own;
        } else {
          return std::nullopt;
        }
      },
      law);
}

std::optional<Law> without_stribeck_slope(const Law& law) {
  const bool has_numbers = std::holds_alternative<Stribeck>(law) || std::holds_alternative<Measured>(law);
  const double mu_s = static_coefficient(law), mu_k = has_numbers ? limit_coefficient(law) : 0.0;
  if (!has_numbers || kind(law) != LawKind::kSpeedDependent || mu_k > mu_s) return std::nullopt;
  return Coulomb{mu_s, mu_k};
}

std::optional<Law> without_stop_damping(const Law& law) {
  const Clearance* play = clearance(law);
  if (play == nullptr) return std::nullopt;
  Clearance other = *play;
  bool any = false;
  for (std::optional<Stop>* stop : {&other.left, &other.right}) {
    if (!*stop || (*stop)->damping == 0.0) continue;
    (*stop)->damping = 0.0;
    any = true;
  }
  return any ? Other(other) : std::nullopt;
}

Law weakened(Law law, double share) {
  std::visit(
      [share](auto& own) {
        if constexpr (requires { own.mu_s; }) own.mu_s *= share;
        if constexpr (requires { own.mu_k; }) own.mu_k *= share;
        if constexpr (requires { own.left; }) {
          for (std::optional<Stop>* stop : {&own.left, &own.right}) {
            if (!*stop) continue;
            (*stop)->stiffness *= share;
            (*stop)->damping *= share;
          }
        }
      },
      law);
  return law;
}

}  // namespace slipmode::friction
