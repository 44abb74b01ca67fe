#include <slipmode/diagnostics/series/linear_region.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace slipmode::diagnostics {
namespace {

TEST(FitLine, RecoversALineAndReportsWhatIsLeft) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(11, 0.0, 10.0);
  Eigen::VectorXd y = (3.0 * x).array() - 2.0;
  const LinearFit exact = fit_line(x, y, 2, 9);
  EXPECT_NEAR(exact.slope, 3.0, 1e-14);
  EXPECT_NEAR(exact.intercept, -2.0, 1e-13);
  EXPECT_NEAR(exact.residual, 0.0, 1e-13);
  EXPECT_NEAR(exact.curvature, 0.0, 1e-13);
  // y = x²: slope over points 0 … 4 is 4, over 2 … 4 is 6, over 0 … 2 is 2.
  y = x.cwiseAbs2();
  const LinearFit bent = fit_line(x, y, 0, 5);
  EXPECT_NEAR(bent.slope, 4.0, 1e-13);
  EXPECT_NEAR(bent.curvature, 2.0, 1e-13);
  // Left of the line 4x − 2: 2, −1, −2, −1, 2.
  EXPECT_NEAR(bent.residual, std::sqrt(14.0 / 5.0), 1e-13);
  EXPECT_THROW((void)fit_line(x, y, 5, 12), InvalidInput);
}

TEST(LinearRegion, FindsTheStraightPartBetweenATransientAndAPlateau) {
  // Rises by x² up to 5, by a line of slope 2 up to 20, then levels off exponentially.
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(41, 0.0, 40.0);
  Eigen::VectorXd y(41);
  for (Eigen::Index k = 0; k < 41; ++k) {
    const double t = x(k);
    y(k) = t < 5.0 ? 0.2 * t * t : t <= 20.0 ? 5.0 + 2.0 * (t - 5.0) : 35.0 + 4.0 * (1.0 - std::exp(-(t - 20.0) / 2.0));
  }
  Random random(3);
  for (double& value : y) value += 1e-4 * random.normal();
  const LinearFit fit = linear_region(x, y);
  EXPECT_GE(fit.begin, 5);
  EXPECT_LE(fit.end, 21);
  EXPECT_NEAR(fit.slope, 2.0, 1e-4);
}

TEST(LinearRegion, CoversTheWidthAskedFor) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(101, 0.0, 10.0);
  const Eigen::VectorXd y = 0.5 * x.array() + 0.3 * (2.0 * x.array()).sin();  // swings with period π
  const LinearFit wide = linear_region(x, y, {.least_width = 6.28});
  EXPECT_GE(x(wide.end - 1) - x(wide.begin), 6.28 - 1e-12);
  EXPECT_NEAR(wide.slope, 0.5, 0.06);
  EXPECT_THROW((void)linear_region(x, y, {.least_width = 11.0}), NumericalFailure);
  EXPECT_THROW((void)linear_region(x, y, {.least_points = 2}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
