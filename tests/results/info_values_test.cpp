// All values of a file as JSON.
#include <slipmode/results/info.hpp>
#include <slipmode/results/store.hpp>
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace slipmode::results {
namespace {

TEST(InfoValues, GroupsAreObjectsArraysRowsAndWhatIsNotFiniteNull) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "values.h5";
  StoreWriter writer(path, FileKind::kTrajectory);
  writer.write("branches/0/text", std::string("é\"\n"), {"", ""});
  writer.write("branches/10/number", 0.1, {"1", ""});
  writer.write("list",
               Eigen::VectorXd(Eigen::Vector3d(1.0, std::numeric_limits<double>::quiet_NaN(),
                                               std::numeric_limits<double>::infinity())),
               {"1", ""});
  writer.write("matrix", Eigen::MatrixXd((Eigen::MatrixXd(2, 3) << 1, 2, 3, 4, 5, 6).finished()), {"1", ""});
  writer.write("whole", std::vector<std::int64_t>{-1, 9007199254740993}, {"", ""});
  writer.write("words", std::vector<std::string>{"a", ""}, {"", ""});
  writer.write("none", Eigen::VectorXd(), {"1", ""});
  writer.commit();
  const auto expected = nlohmann::json::parse(R"({
    "branches": {"0": {"text": "é\"\n"}, "10": {"number": 0.1}}, "list": [1.0, null, null],
    "matrix": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "whole": [-1, 9007199254740993], "words": ["a", ""], "none": []})");
  EXPECT_EQ(nlohmann::json::parse(info(path, InfoFormat::kValues)), expected);
}

}  // namespace
}  // namespace slipmode::results
