#include "friction/contact.hpp"

#include "core/errors.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::friction {

namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;  // Clang before 17 does not deduce aggregates

struct Checker {
  const Contact& contact;

  [[noreturn]] void fail(const std::string& found, const char* expected) const {
    throw InvalidInput(fmt::format("contact {}: {}; expected {}",
                                   contact.name.empty() ? "(unnamed)" : "'" + contact.name + "'", found, expected));
  }

  void non_negative(const char* key, double value) const {
    if (!(value >= 0.0) || !std::isfinite(value)) {
      fail(fmt::format("{} = {}", key, value), "a finite value >= 0");
    }
  }

  void coefficients(double mu_s, double mu_k) const {
    non_negative("mu_k", mu_k);
    non_negative("mu_s", mu_s);
    if (mu_s < mu_k) {
      fail(fmt::format("mu_s = {} is below mu_k = {}", mu_s, mu_k),
           "mu_s >= mu_k (static friction holds at least as much as sliding friction)");
    }
  }
};

}  // namespace

void validate(const Contact& contact) {
  const Checker check{contact};
  if (contact.direction.size() == 0) check.fail("direction is empty", "one entry per degree of freedom");
  if (!contact.direction.allFinite()) check.fail("direction holds a value that is not finite", "finite entries");
  if ((contact.direction.array() == 0.0).all()) {
    check.fail("direction is zero", "a direction that moves the contact");
  }
  check.non_negative("normal_load", contact.normal_load);
  if (!std::isfinite(contact.offset)) {
    check.fail(fmt::format("offset = {}", contact.offset), "a finite value");
  }
  std::visit(Overloaded{[&](const Coulomb& law) { check.coefficients(law.mu_s, law.mu_k); },
                        [&](const Stribeck& law) {
                          check.coefficients(law.mu_s, law.mu_k);
                          check.non_negative("alpha", law.alpha);
                        },
                        [&](const TanhRegularised& law) {
                          check.coefficients(law.mu_s, law.mu_k);
                          check.non_negative("alpha", law.alpha);
                          if (!(law.epsilon > 0.0) || !std::isfinite(law.epsilon)) {
                            check.fail(fmt::format("epsilon = {}", law.epsilon), "a finite value > 0");
                          }
                        }},
             contact.law);
}

double kinetic_coefficient(const Law& law, double speed) {
  return std::visit(Overloaded{[](const Coulomb& coulomb) { return coulomb.mu_k; },
                               [speed](const Stribeck& stribeck) {
                                 return stribeck.mu_k +
                                        (stribeck.mu_s - stribeck.mu_k) * std::exp(-stribeck.alpha * speed);
                               },
                               [](const TanhRegularised&) -> double {
                                 throw InvalidInput(
                                     "kinetic coefficient: the tanh law has no slip state; evaluate its force over "
                                     "the whole range of velocity");
                               }},
                    law);
}

double static_coefficient(const Law& law) {
  return std::visit([](const auto& any) { return any.mu_s; }, law);
}

bool is_piecewise_linear(const Law& law) {
  return std::visit(
      Overloaded{[](const Coulomb&) { return true; },
                 [](const Stribeck& stribeck) { return stribeck.alpha == 0.0 || stribeck.mu_s == stribeck.mu_k; },
                 [](const TanhRegularised&) { return false; }},
      law);
}

}  // namespace slipmode::friction
