// Parts that a matrix does not couple, and their spectra put together.
#include <slipmode/core/coupled_parts.hpp>

#include <gtest/gtest.h>

namespace slipmode {
namespace {

TEST(CoupledParts, AreFoundThroughEitherTriangleInTheOrderOfTheirFirstIndex) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6);
  A(5, 0) = 1e-300;  // 0 - 5
  A(1, 3) = -2.0;    // 1 - 3 - 4
  A(4, 3) = 1.0;
  EXPECT_EQ(coupled_parts(A), (std::vector<Part>{{0, 5}, {1, 3, 4}, {2}}));
  EXPECT_TRUE(coupled_parts(Eigen::MatrixXd(0, 0)).empty());
}

TEST(CoupledParts, SpectraAreAscendingWithExactZerosBetweenParts) {
  const std::vector<Part> parts = {{0, 2}, {1}};
  const Spectrum all = spectrum_by_parts(parts, [](const Part& part) -> Spectrum {
    if (part.size() == 1) return {Eigen::VectorXd::Constant(1, 3.0), Eigen::MatrixXd::Constant(1, 1, 1.0)};
    return {Eigen::Vector2d(2.0, 5.0), Eigen::MatrixXd{{0.6, -0.8}, {0.8, 0.6}}};
  });
  EXPECT_EQ(all.values, Eigen::Vector3d(2.0, 3.0, 5.0));
  EXPECT_EQ(all.vectors, (Eigen::MatrixXd{{0.6, 0.0, -0.8}, {0.0, 1.0, 0.0}, {0.8, 0.0, 0.6}}));
}

}  // namespace
}  // namespace slipmode
