// A damaged file of ours is refused before libhdf5 sees it.

#include "results/internal/seal.hpp"
#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/results/store.hpp>
#include "results/internal/hdf5_handle.hpp"
#include "scene/messages.hpp"
#include "scene/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slipmode::results {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class Seal : public testing::Test {
 protected:
  void SetUp() override {
    StoreWriter writer(file, FileKind::kSeries);
    writer.write("values", Eigen::VectorXd(Eigen::VectorXd::LinSpaced(1000, 0.0, 1.0)), {"m", "some"});
    writer.commit();
    whole = tests::bytes_of(file);
  }
  void put(const std::string& bytes) const { std::ofstream(file, std::ios::binary) << bytes; }

  tests::TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "result.h5";
  std::string whole;
};

// Independent of zlib: CRC-32 of "123456789" is cbf43926 (the catalogue's check value of CRC-32/ISO-HDLC).
TEST_F(Seal, SaysLengthAndChecksumOfTheRest) {
  put(std::string(kSealBytes, '\0') + "123456789");
  ASSERT_TRUE(seal(file));
  EXPECT_THAT(tests::bytes_of(file),
              testing::StartsWith("slipmode result: HDF5 from byte 512 on, 9 bytes, CRC-32 cbf43926\n"));
  EXPECT_EQ(damage_of(file), "");
}

TEST_F(Seal, FindsAnyChangedByte) {
  Random random(1);
  for (int k = 0; k < 500; ++k) {
    std::string damaged = whole;
    const auto at =
        kSealBytes + static_cast<std::size_t>(random.uniform() * static_cast<double>(whole.size() - kSealBytes));
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (k % 8)));
    put(damaged);
    EXPECT_THAT([&] { (void)StoreReader(file); }, ThrowsMessage<InvalidInput>(HasSubstr("is damaged"))) << at;
  }
}

TEST_F(Seal, FindsMissingAndAddedBytes) {
  for (const std::string& damaged :
       {whole.substr(0, whole.size() / 2), whole.substr(0, 600), whole + '\0', whole + whole}) {
    put(damaged);
    EXPECT_THAT([&] { (void)StoreReader(file); }, ThrowsMessage<InvalidInput>(HasSubstr("is damaged")));
  }
}

TEST_F(Seal, OfAFileThatIsGoneFails) { EXPECT_FALSE(seal(folder.path() / "none.h5")); }

// What h5py, MATLAB and earlier versions write has no seal.
TEST_F(Seal, IsNotAskedOfOtherFiles) {
  std::string foreign = whole;
  foreign.replace(0, kSealBytes, std::string(kSealBytes, '\0'));
  put(foreign);
  EXPECT_EQ(StoreReader(file).vector("values", 1000)(999), 1.0);
  std::filesystem::remove(file);
  {
    const Hdf5Handle made(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    const hsize_t one = 1;
    const Hdf5Handle space(H5Screate_simple(1, &one, nullptr), H5Sclose);
    const Hdf5Handle set(H5Dcreate2(made.id(), "x", H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Dclose);
  }
  EXPECT_TRUE(is_hdf5(file));
  EXPECT_TRUE(StoreReader(file).has("x"));
}

}  // namespace
}  // namespace slipmode::results
