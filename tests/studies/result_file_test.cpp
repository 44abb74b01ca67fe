// A study's file goes on only from its own journal.

#include <slipmode/core/errors.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/result_file.hpp>
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>

namespace slipmode::studies {
namespace {

pod::Basis two_modes_of_three() {
  pod::Basis basis;
  basis.vectors = Eigen::MatrixXd::Identity(3, 2);
  basis.mean = Eigen::VectorXd::Zero(3);
  return basis;
}

TEST(IdentityOfABasis, SeesVectorsShapeAndMean) {
  const pod::Basis basis = two_modes_of_three();
  pod::Basis turned = basis, shifted = basis, wide = basis;
  turned.vectors(0, 0) = std::nextafter(1.0, 2.0);
  shifted.mean[2] = 1e-300;
  wide.vectors = basis.vectors.reshaped(2, 3);
  EXPECT_EQ(identity_of(basis), identity_of(two_modes_of_three()));
  EXPECT_NE(identity_of(basis), identity_of(turned));
  EXPECT_NE(identity_of(basis), identity_of(shifted));
  EXPECT_NE(identity_of(basis), identity_of(wide));
}

TEST(ResultFile, GoesOnFromItsOwnJournalAndRefusesAnother) {
  const tests::TemporaryFolder folder;
  const scene::Scene scene = scene::load_scene(std::string(SLIPMODE_SOURCE_DIR) + "/datasets/chain10/scene.toml");
  const std::string identity = identity_of(two_modes_of_three());
  {
    ResultFile interrupted(folder.path() / "sweep.h5", scene, results::FileKind::kSweep, "slipmode sweep", identity);
    EXPECT_EQ(interrupted.resumed(), 0U);
    interrupted.journal()->append({"full", 0, {0.25}, ""});
  }
  EXPECT_THROW(ResultFile(folder.path() / "sweep.h5", scene, results::FileKind::kSweep, "slipmode sweep", "another"),
               InvalidInput);
  EXPECT_THROW(
      ResultFile(folder.path() / "sweep.h5", scene, results::FileKind::kSweep, "slipmode sweep --follow", identity),
      InvalidInput);
  EXPECT_THROW(ResultFile(folder.path() / "sweep.h5", scene::set_key(scene, "drive.speed", 0.3),
                          results::FileKind::kSweep, "slipmode sweep", identity),
               InvalidInput);
  ResultFile again(folder.path() / "sweep.h5", scene, results::FileKind::kSweep, "slipmode sweep", identity);
  EXPECT_EQ(again.resumed(), 1U);
  again.finish([](results::StoreWriter&) {});
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "sweep.h5"));
  EXPECT_FALSE(std::filesystem::exists(results::Journal::path_for(folder.path() / "sweep.h5")));
}

TEST(ResultFile, LeavesNothingInTheCacheOfAStudyThatKeptNothing) {
  const tests::TemporaryFolder folder;
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string own = before == nullptr ? "" : before;
  setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
  const scene::Scene scene = scene::load_scene(std::string(SLIPMODE_SOURCE_DIR) + "/datasets/chain10/scene.toml");
  const auto left = [&] {
    return std::distance(std::filesystem::directory_iterator(folder.path() / "slipmode"),
                         std::filesystem::directory_iterator());
  };
  const auto fail_after = [&](int records) {
    ResultFile failed("", scene, results::FileKind::kTrade, "slipmode trade", "", {}, {}, Unfinished::kKept);
    EXPECT_EQ(left(), 1) << "its journal";
    for (int i = 0; i < records; ++i) failed.journal()->append({"row", i, {0.25}, ""});
  };
  fail_after(0);
  EXPECT_EQ(left(), 0);
  fail_after(1);
  EXPECT_EQ(left(), 1) << "what is finished is kept";
  if (before == nullptr) {
    unsetenv("XDG_CACHE_HOME");
  } else {
    setenv("XDG_CACHE_HOME", own.c_str(), 1);
  }
}

}  // namespace
}  // namespace slipmode::studies
