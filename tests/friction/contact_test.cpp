#include <slipmode/friction/contact.hpp>

#include <slipmode/core/errors.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <limits>

namespace slipmode::friction {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Stribeck, StartsAtTheStaticCoefficient) {
  const Law law = Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = 8.0};
  EXPECT_EQ(kinetic_coefficient(law, 0.0), static_coefficient(law));  // S4 (3.5): the law is continuous at v = 0
}

TEST(Stribeck, FollowsItsFormula) {
  const Law law = Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = 8.0};
  EXPECT_DOUBLE_EQ(kinetic_coefficient(law, 0.2), 0.2 + 0.2 * std::exp(-1.6));  // S4 (3.5)
}

TEST(Stribeck, TendsToCoulombAsAlphaGrows) {
  const Law coulomb = Coulomb{.mu_s = 0.4, .mu_k = 0.2};
  for (const double alpha : {1e2, 1e4, 1e300}) {
    const Law law = Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = alpha};
    // the distance is (μ_s − μ_k) e^{−α v}, by the formula
    EXPECT_NEAR(kinetic_coefficient(law, 0.5), kinetic_coefficient(coulomb, 0.5), 0.2 * std::exp(-alpha * 0.5) + 1e-16);
  }
}

TEST(Stribeck, TendsToTheStaticCoefficientAsAlphaVanishes) {
  for (const double alpha : {1e-3, 1e-6, 1e-9}) {
    const Law law = Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = alpha};
    EXPECT_NEAR(kinetic_coefficient(law, 2.0), 0.4, 0.2 * alpha * 2.0);  // 1 − e^{−x} ≤ x
  }
  EXPECT_EQ(kinetic_coefficient(Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = 0.0}, 1e9), 0.4);
}

TEST(Stribeck, TendsToTheKineticCoefficientAtHighSpeed) {
  const Law law = Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = 8.0};
  EXPECT_EQ(kinetic_coefficient(law, 1e6), 0.2);
  EXPECT_EQ(kinetic_coefficient(law, std::numeric_limits<double>::max()), 0.2);  // no overflow, no NaN
}

TEST(Stribeck, FallsMonotonicallyWithSpeed) {
  const Law law = Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = 8.0};
  for (double v = 0.0; v < 3.0; v += 0.01) {
    EXPECT_GT(kinetic_coefficient(law, v), kinetic_coefficient(law, v + 0.01));
  }
}

TEST(Coulomb, DoesNotDependOnSpeed) {
  const Law law = Coulomb{.mu_s = 0.4, .mu_k = 0.2};
  EXPECT_EQ(kinetic_coefficient(law, 0.0), 0.2);
  EXPECT_EQ(kinetic_coefficient(law, 1e9), 0.2);
  EXPECT_EQ(static_coefficient(law), 0.4);
}

TEST(Laws, PiecewiseLinearOnesAreRecognised) {
  EXPECT_TRUE(is_piecewise_linear(Coulomb{.mu_s = 0.4, .mu_k = 0.2}));
  EXPECT_FALSE(is_piecewise_linear(Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = 8.0}));
  EXPECT_TRUE(is_piecewise_linear(Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = 0.0}));
  EXPECT_TRUE(is_piecewise_linear(Stribeck{.mu_s = 0.3, .mu_k = 0.3, .alpha = 8.0}));
  EXPECT_FALSE(is_piecewise_linear(TanhRegularised{.mu_s = 0.4, .mu_k = 0.2}));
}

TEST(Laws, TanhCreepsFromZero) {
  const Law law = TanhRegularised{.mu_s = 0.4, .mu_k = 0.2, .alpha = 8.0, .epsilon = 0.1};
  EXPECT_EQ(static_coefficient(law), 0.4);
  EXPECT_EQ(kinetic_coefficient(law, 0.0), 0.0);
  const double th = std::tanh(2.0);  // v/ε; by its formula, |v| ≈ v tanh(v/ε)
  EXPECT_DOUBLE_EQ(kinetic_coefficient(law, 0.2), (0.2 + 0.2 * std::exp(-1.6 * th)) * th);
}

TEST(Laws, AreWhatTheyAreToAFlow) {
  EXPECT_EQ(kind(Coulomb{0.4, 0.2}), LawKind::kConstant);
  EXPECT_EQ(kind(Stribeck{0.4, 0.2, 8.0}), LawKind::kSpeedDependent);
  EXPECT_EQ(kind(Stribeck{0.4, 0.2, 0.0}), LawKind::kConstant);
  EXPECT_EQ(kind(TanhRegularised{}), LawKind::kSmooth);
  EXPECT_EQ(kind(CompliantCoulomb{}), LawKind::kCompliant);
  EXPECT_EQ(kind(Dahl{}), LawKind::kBristle);
  EXPECT_EQ(kind(LuGre{}), LawKind::kBristle);
  EXPECT_EQ(kind(Clearance{}), LawKind::kClearance);
  EXPECT_EQ(kind(Measured{.mu_s = 0.1}), LawKind::kSpeedDependent);
  EXPECT_EQ(kind(Characteristic{.mu_s = 0.1}), LawKind::kSpeedDependent);
  EXPECT_EQ(kind(Measured{}), LawKind::kSmooth);
  EXPECT_EQ(kind(Characteristic{}), LawKind::kSmooth);
}

TEST(Laws, ForcesHaveTheirOwnSlope) {
  // Central differences, error h²/6 of the third derivative.
  const auto square = [](double v) { return 0.2 + 0.1 * v * v; };
  const Law laws[] = {Stribeck{0.4, 0.2, 8.0}, TanhRegularised{0.4, 0.2, 8.0, 0.1},
                      Characteristic{.mu_s = 0.3, .mu = square, .slope = [](double v) { return 0.2 * v; }}};
  for (const Law& law : laws) {
    const ContactForces f = contact_forces({.direction = Eigen::VectorXd::Ones(1), .law = law, .normal_load = 3.0});
    for (const double direction : {1.0, -1.0}) {
      const double v = 0.3 * direction, h = 1e-5;
      const double expected = (f.sliding(direction, v + h) - f.sliding(direction, v - h)) / (2.0 * h);
      EXPECT_NEAR(f.slope(direction, v), expected, 1e-7);
      EXPECT_NEAR(f.sliding(direction, v), 3.0 * direction * kinetic_coefficient(law, 0.3), 1e-15);
    }
  }
}

TEST(Laws, AFlatStribeckLawIsCoulombOnATiltToo) {
  const auto on_tilt = [](Law law) {
    return contact_forces({.direction = Eigen::VectorXd::Ones(1), .law = law, .normal_load = 3.0, .tilt = 0.1});
  };
  const ContactForces flat = on_tilt(Stribeck{0.4, 0.2, 0.0}), coulomb = on_tilt(Coulomb{0.4, 0.4});
  EXPECT_EQ(flat.mu_s, coulomb.mu_s);
  EXPECT_EQ(flat.mu_k, coulomb.mu_k);
}

TEST(Laws, OnesWithoutNumbersHaveNoWord) {
  EXPECT_THAT(law_words(),
              testing::ElementsAre("coulomb", "stribeck", "tanh", "compliant", "dahl", "lugre", "clearance", "table"));
  EXPECT_EQ(law_word(LuGre{}), "lugre");
  EXPECT_THAT([] { (void)law_word(Characteristic{}); }, ThrowsMessage<InvalidInput>(HasSubstr("a file cannot hold")));
}

TEST(ContactValidation, AcceptsTheExtremesOfTheValidRange) {
  const Eigen::VectorXd w = Eigen::VectorXd::Unit(3, 2);
  EXPECT_NO_THROW(validate({.direction = w, .law = Coulomb{.mu_s = 0.0, .mu_k = 0.0}, .normal_load = 0.0}));
  EXPECT_NO_THROW(validate({.direction = w, .law = Coulomb{.mu_s = 0.3, .mu_k = 0.3}}));
  EXPECT_NO_THROW(validate({.direction = 1e-300 * w, .law = Stribeck{.mu_s = 1e6, .mu_k = 0.0, .alpha = 0.0}}));
}

TEST(ContactValidation, NamesTheContactTheValueAndTheRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::VectorXd w = Eigen::VectorXd::Unit(3, 2);
  const auto fails = [](const Contact& contact, const char* message) {
    EXPECT_THAT([&] { validate(contact); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  fails({.direction = w, .law = Coulomb{.mu_s = 0.1, .mu_k = 0.2}, .name = "belt"},
        "contact 'belt': mu_s = 0.1 is below mu_k = 0.2; expected mu_s >= mu_k");
  fails({.direction = w, .law = Coulomb{.mu_s = 0.1, .mu_k = -0.2}}, "contact (unnamed): mu_k = -0.2");
  fails({.direction = w, .law = Coulomb{.mu_s = nan, .mu_k = 0.2}}, "mu_s = nan; expected a finite value >= 0");
  fails({.direction = w, .law = Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = -1.0}}, "alpha = -1");
  fails({.direction = w, .law = TanhRegularised{.mu_s = 0.4, .mu_k = 0.2, .epsilon = 0.0}}, "epsilon = 0");
  const auto third = [](double) { return 1.0 / 3.0; };
  fails({.direction = w, .law = Characteristic{.mu_s = 0.4, .mu = third}}, "without its functions");
  fails({.direction = w, .law = Characteristic{.mu_s = 0.3, .mu = third, .slope = third}}, "below mu(0) = 0.3333");
  fails({.direction = w, .law = Coulomb{}, .normal_load = -3.0}, "normal_load = -3");
  fails({.direction = w, .law = Coulomb{}, .normal_load = std::numeric_limits<double>::infinity()},
        "normal_load = inf");
  fails({.direction = w, .law = Coulomb{}, .offset = nan}, "offset = nan");
  fails({.direction = Eigen::VectorXd::Zero(3), .law = Coulomb{}}, "direction is zero");
  fails({.direction = {}, .law = Coulomb{}}, "direction is empty");
  fails({.direction = nan * w, .law = Coulomb{}}, "direction holds a value that is not finite");
}

}  // namespace
}  // namespace slipmode::friction
