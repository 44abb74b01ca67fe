#include <slipmode/friction/contact.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/friction/load_form.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::friction {

namespace {

struct Checker {
  const Contact& contact;

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw InvalidInput(fmt::format("contact {}: {}; expected {}",
                                   contact.name.empty() ? "(unnamed)" : "'" + contact.name + "'", found, expected));
  }

  void within(const std::string& key, double value, const Limits& limits) const {
    if (limits.hold(value)) return;
    const char* range = limits.low < 0.0 ? "" : limits.above ? " > 0" : " >= 0";
    fail(fmt::format("{} = {}", key, value), fmt::format("a finite value{}", range));
  }

  /// Every number of `own` within its field's limits.
  template <class S>
  void fields(const S& own, const std::string& whose = "") const {
    for_each_field<S>([&]<class T>(const Field<S, T>& field) {
      if constexpr (std::is_same_v<T, double>) within(whose + field.name, own.*field.member, field.limits);
      if constexpr (std::is_same_v<T, std::vector<double>>)
        for (const double value : own.*field.member) within(whose + field.name, value, field.limits);
    });
  }

  /// @param name      of the coefficient in slip, mu
  /// @param rounding  of a coefficient that was computed, relative
  void holds_at_rest(double mu_s, const std::string& name, double mu, double rounding = 0.0) const {
    if (mu_s < mu * (1.0 - rounding))
      fail(fmt::format("mu_s = {} is below {} = {}", mu_s, name, mu),
           fmt::format("mu_s >= {} (static friction holds at least as much as sliding friction)", name));
  }

  void load(const NormalLoad& load) const {
    within("normal_load", load.constant, kNonNegative);
    within("normal_load slope", load.slope, kFinite);
    if (!load.oscillator) return;
    if (load.slope != 0.0)
      fail(fmt::format("normal_load has a slope of {} and an oscillator", load.slope),
           "one of them (the oscillator has its own slope)");
    fields(*load.oscillator, "oscillator ");
  }

  void tilted(double mu) const {
    for (const double direction : {-1.0, 1.0}) {
      if (std::cos(contact.tilt) - direction * mu * std::sin(contact.tilt) <= 0.0)
        fail(fmt::format("tilt = {} rad with mu = {} jams the slider", contact.tilt, mu), "mu tan|tilt| < 1");
      if (effective_coefficient(mu, contact.tilt, direction) < 0.0)
        fail(fmt::format("tilt = {} rad with mu = {} slides by itself", contact.tilt, mu), "tan|tilt| <= mu");
    }
  }

  void law(const Clearance& law) const {
    if (!law.left && !law.right) fail("a clearance without stops", "a left stop, a right stop, or both");
    if (law.left) fields(*law.left, "left stop ");
    if (law.right) fields(*law.right, "right stop ");
    if (law.left && law.right && law.left->gap + law.right->gap < 0.0)
      fail(fmt::format("the stops overlap: left gap {} + right gap {} < 0", law.left->gap, law.right->gap),
           "gaps whose sum is >= 0");
    if (contact.tilt != 0.0) fail(fmt::format("tilt = {} rad with a clearance", contact.tilt), "no tilt");
    if (!contact.normal_load.is_constant())
      fail("a normal load that varies, with a clearance", "no normal load: a clearance has no friction");
  }

  void law(const Characteristic& law) const {
    if (!law.mu || !law.slope) fail("a characteristic without its functions", "mu and slope, of the sliding speed");
    within("mu_s", law.mu_s, kNonNegative);
    within("mu(0)", law.mu(0.0), kNonNegative);
    within("slope(0)", law.slope(0.0), kFinite);
    holds_at_rest(law.mu_s, "mu(0)", law.mu(0.0), 1e-12);
    if (law.bounds && !(law.most > 0.0 && law.most >= law.mu(0.0) && std::isfinite(law.most)))
      fail(fmt::format("bounds with most = {}", law.most), "the largest coefficient, > 0 and >= mu(0)");
  }

  void law(const Measured& law) const {
    fields(law);
    if (const auto fault = fault_of(law)) fail(fmt::format("{}: {}", fault->field, fault->found), fault->expected);
  }

  void law(const auto& law) const {
    fields(law);
    if constexpr (requires { law.mu_s < law.mu_k; }) holds_at_rest(law.mu_s, "mu_k", law.mu_k);
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
  check.load(contact.normal_load);
  check.within("offset", contact.offset, kFinite);
  std::visit([&check](const auto& law) { check.law(law); }, contact.law);
  check.within("tilt", contact.tilt, kFinite);
  if (clearance(contact.law) != nullptr) return;
  if (!is_piecewise_linear(contact.law)) {
    if (contact.tilt != 0.0)
      check.fail(fmt::format("tilt = {} rad with a law that is not Coulomb", contact.tilt),
                 "a Coulomb law, rigid or compliant, or no tilt");
    if (!contact.normal_load.is_constant())
      check.fail("a normal load that varies, with a law that is not Coulomb",
                 "a Coulomb law, rigid or compliant, or a constant load");
  } else if (contact.tilt != 0.0) {
    if (std::abs(contact.tilt) >= std::numbers::pi / 2.0)
      check.fail(fmt::format("tilt = {} rad", contact.tilt), "an angle below pi/2");
    check.tilted(kinetic_coefficient(contact.law, 0.0));
    check.tilted(static_coefficient(contact.law));
  }
}

std::vector<std::string> law_words() {
  std::vector<std::string> words;
  [&]<class... Laws>(const std::variant<Laws...>& /*any*/) {
    const auto add = [&]<class Own>(const Own* /*any*/) {
      if constexpr (requires { Own::word; }) words.emplace_back(Own::word);
    };
    (add(static_cast<const Laws*>(nullptr)), ...);
  }(Law());
  return words;
}

std::string law_word(const Law& law) {
  return std::visit(
      []<class Own>(const Own& /*law*/) -> std::string {
        if constexpr (requires { Own::word; })
          return Own::word;
        else
          throw InvalidInput(fmt::format(
              "a friction characteristic is made of the program's own functions, which a file cannot hold; expected a "
              "law made of numbers: {}",
              fmt::join(law_words(), ", ")));
      },
      law);
}

LawKind kind(const Law& law) {
  return std::visit([](const auto& own) { return own.kind(); }, law);
}

double kinetic_coefficient(const Law& law, double speed) {
  return std::visit([speed](const auto& own) { return own.kinetic_coefficient(speed); }, law);
}

double limit_coefficient(const Law& law) {
  return std::visit([](const auto& own) { return own.limit_coefficient(); }, law);
}

double static_coefficient(const Law& law) {
  return std::visit([](const auto& own) { return own.static_coefficient(); }, law);
}

double spring_stiffness(const Law& law) {
  return std::visit(
      [](const auto& own) {
        if constexpr (requires { own.stiffness; })
          return own.stiffness;
        else
          return 0.0;
      },
      law);
}

double fastest_rate(const Law& law, const Pace& pace) {
  return std::visit([&pace](const auto& own) { return own.fastest_rate(pace); }, law);
}

bool is_piecewise_linear(const Law& law) { return is_piecewise_linear(kind(law)); }

bool is_symmetric(const Law& law) {
  const Clearance* play = clearance(law);
  return play == nullptr || (play->left && play->left == play->right);
}

double effective_coefficient(double mu, double tilt, double direction) {
  const double cosine = std::cos(tilt), sine = direction * std::sin(tilt);
  return (mu * cosine + sine) / (cosine - mu * sine);
}

int internal_states(const Contact& contact) {
  return (remembers(kind(contact.law)) ? 1 : 0) + (contact.normal_load.oscillator ? 2 : 0);
}

ContactForces contact_forces(const Contact& contact) {
  const double N = contact.normal_load.constant;
  ContactForces f = std::visit([N](const auto& own) { return own.forces(N); }, contact.law);
  f.load = N;
  f.varies = LoadForm(contact).varies();
  const double mu_s = static_coefficient(contact.law), mu_k = kinetic_coefficient(contact.law, 0.0);
  for (const int k : {0, 1}) {
    f.mu_s[static_cast<std::size_t>(k)] = effective_coefficient(mu_s, contact.tilt, 2.0 * k - 1.0);
    f.mu_k[static_cast<std::size_t>(k)] = effective_coefficient(mu_k, contact.tilt, 2.0 * k - 1.0);
  }
  f.static_limit = std::max(f.limit(-1.0), f.limit(1.0));
  // A characteristic may rise from nothing.
  const bool may_rise = f.characteristic != nullptr && (!f.characteristic->bounds || f.characteristic->most > 0.0);
  const bool idle = (mu_s == 0.0 && !may_rise) || (N == 0.0 && !f.varies);
  if (idle && f.kind != LawKind::kClearance) {
    f.kind = LawKind::kFree;
    f.characteristic.reset();
    f.varies = false;
  }
  return f;
}

}  // namespace slipmode::friction
