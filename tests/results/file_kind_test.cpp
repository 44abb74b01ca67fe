#include <slipmode/results/file_kind.hpp>
#include <slipmode/results/info.hpp>
#include <slipmode/results/store.hpp>
#include "results/internal/hdf5_handle.hpp"
#include "results/internal/seal.hpp"
#include "scene/messages.hpp"
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

namespace {

using namespace slipmode::results;
using slipmode::tests::expect_parts;
using slipmode::tests::message_of;
using slipmode::tests::TemporaryFolder;

/// A file with these groups.
std::filesystem::path written(const TemporaryFolder& folder, FileKind kind, const std::vector<std::string>& groups) {
  const auto path = folder.path() / "file.h5";
  StoreWriter out(path, kind);
  for (const std::string& group : groups) out.describe_group(group, "something");
  out.commit();
  return path;
}

/// Takes the kind out of a file, or puts another word there; and the seal off, which would refuse the change.
void rewrite_kind(const std::filesystem::path& path, const std::string& word) {
  std::fstream(path, std::ios::binary | std::ios::in | std::ios::out) << std::string(kSealBytes, '\0');
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  ASSERT_GE(H5Adelete(file.id(), "kind"), 0);
  if (word.empty()) return;
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), word.size());
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle made(H5Acreate2(file.id(), "kind", type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  ASSERT_GE(H5Awrite(made.id(), type.id(), word.data()), 0);
}

TEST(FileKind, EachHasAWordOfItsOwn) {
  std::set<std::string> words;
  for (const FileKindWords& entry : kFileKinds) words.insert(entry.word);
  EXPECT_EQ(words.size(), kFileKinds.size());
  EXPECT_EQ(kFileKinds.size(), static_cast<std::size_t>(FileKind::kTrade) + 1);  // the last of the enumeration
  EXPECT_STREQ(words_of(FileKind::kTrade).word, "trade");
}

TEST(FileKind, StandsInTheFileAndDecidesWhateverElseThereIs) {
  const TemporaryFolder folder;
  for (std::size_t k = 0; k < kFileKinds.size(); ++k) {
    const auto path = written(folder, static_cast<FileKind>(k), {"map", "trajectory"});
    const StoreReader in(path);
    EXPECT_EQ(in.attribute("kind"), kFileKinds[k].word);
    EXPECT_EQ(in.attribute("description"), kFileKinds[k].meaning);
    EXPECT_EQ(kind_of(in), static_cast<FileKind>(k));
    expect_parts(info(path), {std::string("file.h5: ") + kFileKinds[k].word, kFileKinds[k].meaning});
    EXPECT_EQ(nlohmann::json::parse(info(path, InfoFormat::kJson))["kind"], kFileKinds[k].word);
  }
}

/// The groups that verbs of version 0.1 wrote before files had a kind (2026-11-22), provenance aside.
TEST(FileKind, FilesWithoutOneAreToldByWhatTheyHold) {
  const std::pair<FileKind, std::vector<std::string>> layouts[] = {
      {FileKind::kTrajectory, {"trajectory", "sensors"}},
      {FileKind::kEnsemble, {"ensemble", "members", "sensors"}},
      {FileKind::kPod, {"pod"}},
      {FileKind::kPod, {"pod", "pomf"}},
      {FileKind::kBasis, {"basis"}},
      {FileKind::kReduced, {"reduced"}},
      {FileKind::kModes, {"modes"}},
      {FileKind::kValidation, {"validation", "sweep", "portraits", "verdict"}},
      {FileKind::kValidation, {"shaken_validation"}},
      {FileKind::kSweep, {"sweep"}},
      {FileKind::kExponents, {"exponents/0"}},
      {FileKind::kExponentSweep, {"exponents/full", "sweep/full"}},
      {FileKind::kVerdict, {"exponents/0", "verdict"}},
      {FileKind::kSeries, {"diagnosis"}},
      {FileKind::kReturns, {"returns"}},
      {FileKind::kOrbit, {"orbit", "trajectory"}},
      {FileKind::kBranches, {"branches"}},
      {FileKind::kMap, {"map"}},
      {FileKind::kStrobe, {"strobe"}},
      {FileKind::kSkeleton, {"skeleton/full"}},
      {FileKind::kTrade, {"trade"}},
  };
  const TemporaryFolder folder;
  for (const auto& [kind, groups] : layouts) {
    const auto path = written(folder, FileKind::kTrajectory, groups);
    rewrite_kind(path, "");
    EXPECT_EQ(kind_of(StoreReader(path)), kind) << words_of(kind).word;
  }
}

TEST(FileKind, OfAnotherProgramThereIsNone) {
  const TemporaryFolder folder;
  const auto path = written(folder, FileKind::kSweep, {"measured"});
  rewrite_kind(path, "");
  EXPECT_EQ(kind_of(StoreReader(path)), std::nullopt);
  EXPECT_TRUE(nlohmann::json::parse(info(path, InfoFormat::kJson))["kind"].is_null());
  const auto needed = [&] { require_kind(StoreReader(path), std::array{FileKind::kPod}); };
  expect_parts(message_of(needed), {"file.h5", "no result of slipmode"});
  rewrite_kind(written(folder, FileKind::kSweep, {"sweep"}), "dream");
  EXPECT_EQ(kind_of(StoreReader(path)), std::nullopt);
  expect_parts(message_of(needed), {"'dream'", "unknown to this version"});
}

TEST(FileKind, TheWrongOneIsNamedWithWhatWasExpected) {
  const TemporaryFolder folder;
  const StoreReader in(written(folder, FileKind::kSweep, {}));
  EXPECT_EQ(message_of([&] {
              require_kind(in, std::array{FileKind::kPod, FileKind::kEnsemble, FileKind::kReduced});
            }),
            "'" + in.path().string() +
                "' holds a sweep; expected a POD, an ensemble or a reduced model; 'slipmode pod' makes one");
  EXPECT_EQ(require_kind(in, std::array{FileKind::kPod, FileKind::kSweep}), FileKind::kSweep);
}

}  // namespace
