#include <slipmode/core/errors.hpp>
#include <slipmode/results/info.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/table.hpp>
#include "results/internal/seal.hpp"
#include "scene/messages.hpp"
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

namespace {

using namespace slipmode;
using namespace slipmode::results;
using slipmode::tests::bytes_of;
using slipmode::tests::expect_parts;
using slipmode::tests::message_of;
using slipmode::tests::TemporaryFolder;

TEST(Store, DeflatesWhatShrinksAndNothingElse) {
  const TemporaryFolder folder;
  const auto size_with = [&](const Eigen::VectorXd& values) {
    const auto path = folder.path() / "a.h5";
    StoreWriter out(path, FileKind::kTrajectory);
    out.write("values", values, {"s", "values"});
    out.commit();
    EXPECT_EQ(StoreReader(path).vector("values"), values);
    return static_cast<double>(std::filesystem::file_size(path)) / static_cast<double>(values.size());
  };
  EXPECT_GT(size_with(Eigen::VectorXd::Random(100000)), 8.0);
  EXPECT_LT(size_with(Eigen::VectorXd::LinSpaced(100000, 0.0, 99999.0)), 2.0);
}

TEST(Store, EveryTypeReadsBackToTheSameBits) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.h5";
  const Eigen::MatrixXd large = Eigen::MatrixXd::Random(7, 5000);  // chunked
  StoreWriter out(path, FileKind::kTrajectory);
  out.write("number", 0.1 + 0.2, {"m", "a number"});
  out.write("g/integer", std::int64_t{-7}, {"", "an integer"});
  out.write("g/text", std::string("line 1\nμ_s"), {"", "a text"});
  out.write("g/empty", std::string(), {"", "an empty text"});
  out.write("g/h/vector", std::vector<double>{1.0, -std::numeric_limits<double>::infinity(), 5e-324}, {"1", "v"});
  out.write("g/none", std::vector<double>{}, {"1", "no values"});
  out.write("g/integers", std::vector<std::int64_t>{1, 1LL << 62}, {"", "i"});
  out.write("g/texts", std::vector<std::string>{"a", "", "ccc"}, {"", "t"});
  out.write("g/matrix", large, {"m", "rows as rows"});
  out.write_columns("g/columns", large, {"m", "columns as rows"});
  out.commit();

  const StoreReader in(path);
  EXPECT_EQ(in.number("number"), 0.1 + 0.2);
  EXPECT_EQ(in.integer("g/integer"), -7);
  EXPECT_EQ(in.text("g/text"), "line 1\nμ_s");
  EXPECT_EQ(in.text("g/empty"), "");
  const Eigen::VectorXd vector = in.vector("g/h/vector", 3);
  EXPECT_EQ(vector(1), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(vector(2), 5e-324);
  EXPECT_EQ(in.vector("g/none").size(), 0);
  EXPECT_EQ(in.integers("g/integers"), (std::vector<std::int64_t>{1, 1LL << 62}));
  EXPECT_EQ(in.texts("g/texts"), (std::vector<std::string>{"a", "", "ccc"}));
  EXPECT_EQ(in.matrix("g/matrix", 7, 5000), large);
  EXPECT_EQ(in.columns("g/columns", 7, 5000), large);
  EXPECT_EQ(in.entry("g/matrix").shape, (std::vector<std::int64_t>{7, 5000}));
  EXPECT_EQ(in.entry("g/columns").shape, (std::vector<std::int64_t>{5000, 7}));
  EXPECT_EQ(in.entry("number").meaning.units, "m");
  EXPECT_EQ(in.entry("number").meaning.description, "a number");
  EXPECT_EQ(in.names("g/h"), (std::vector<std::string>{"vector"}));
  EXPECT_TRUE(in.has("g/h/vector"));
  EXPECT_FALSE(in.has("x/y/z"));
}

TEST(Store, UnitsOfADimensionlessModelAreOne) {
  const TemporaryFolder folder;
  const auto units_in = [&](const std::string& system, const Meaning& meaning) {
    StoreWriter out(folder.path() / "a.h5", FileKind::kTrajectory, system);
    out.write("number", 1.0, meaning);
    out.commit();
    return StoreReader(folder.path() / "a.h5").entry("number").meaning.units;
  };
  for (const char* units : {"m", "kg", "N s/m", "1/s, s", "rad/s", "Hz"}) {
    EXPECT_EQ(units_in("dimensionless", {units, ""}), "1") << units;
    EXPECT_EQ(units_in("SI", {units, ""}), units);
  }
  for (const char* units : {"", "1", "%", "rad"}) EXPECT_EQ(units_in("dimensionless", {units, ""}), units);
  EXPECT_EQ(units_in("dimensionless", {"s", "of a clock", Meaning::Of::kClock}), "s");
}

TEST(Store, SameContentGivesTheSameBytes) {
  const TemporaryFolder folder;
  for (const char* name : {"a.h5", "b.h5"}) {
    StoreWriter out(folder.path() / name, FileKind::kTrajectory);
    out.describe_group("g", "a group");
    out.write("g/large", Eigen::MatrixXd(Eigen::MatrixXd::Constant(300, 200, 0.1)), {"m", "constant"});
    out.commit();
    ::sleep(1);  // time stamps, if there were any, would differ
  }
  EXPECT_EQ(bytes_of(folder.path() / "a.h5"), bytes_of(folder.path() / "b.h5"));
}

TEST(Store, NothingIsLeftWithoutCommit) {
  const TemporaryFolder folder;
  {
    StoreWriter out(folder.path() / "a.h5", FileKind::kTrajectory);
    out.write("x", 1.0, {"1", "x"});
    EXPECT_FALSE(folder.names().empty());  // the temporary
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(Store, OldResultStaysUntilTheNewOneIsWhole) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.h5";
  StoreWriter first(path, FileKind::kTrajectory);
  first.write("x", 1.0, {"1", "x"});
  first.commit();
  {
    StoreWriter abandoned(path, FileKind::kTrajectory);
    abandoned.write("x", 2.0, {"1", "x"});
    EXPECT_EQ(StoreReader(path).number("x"), 1.0);
  }
  EXPECT_EQ(StoreReader(path).number("x"), 1.0);
  StoreWriter second(path, FileKind::kTrajectory);
  second.write("x", 3.0, {"1", "x"});
  second.commit();
  EXPECT_EQ(StoreReader(path).number("x"), 3.0);
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"a.h5"}));
}

TEST(Store, MistakesOfTheWriterAreNamed) {
  const TemporaryFolder folder;
  StoreWriter out(folder.path() / "a.h5", FileKind::kTrajectory);
  out.write("x", 1.0, {"1", "x"});
  expect_parts(message_of([&] { out.write("x", 2.0, {"1", "x"}); }), {"a.h5", "x", "already"});
  out.commit();
  expect_parts(message_of([&] { out.write("y", 2.0, {"1", "y"}); }), {"a.h5", "y", "committed"});
}

TEST(Store, OutputFolderMissingOrNotWritableIsNamed) {
  const TemporaryFolder folder;
  expect_parts(message_of([&] { StoreWriter out(folder.path() / "no" / "a.h5", FileKind::kTrajectory); }),
               {(folder.path() / "no" / "a.h5").string(), "does not exist", "mkdir"});
  expect_parts(message_of([&] { StoreWriter out(folder.path(), FileKind::kTrajectory); }), {"is a folder"});
  expect_parts(message_of([&] { StoreWriter out("/proc/slipmode.h5", FileKind::kTrajectory); }),
               {"/proc/slipmode.h5", "cannot be written"});
  EXPECT_TRUE(folder.names().empty());
}

TEST(Store, FilesThatAreNotResultsAreNamed) {
  const TemporaryFolder folder;
  const auto text = folder.path() / "text.h5";
  std::ofstream(text) << "title = \"not HDF5\"\n";
  const auto empty = folder.path() / "empty.h5";
  std::ofstream(empty).flush();
  expect_parts(message_of([&] { StoreReader in(text); }), {text.string(), "not an HDF5 file"});
  expect_parts(message_of([&] { StoreReader in(empty); }), {empty.string(), "is empty"});
  expect_parts(message_of([&] { StoreReader in(folder.path() / "none.h5"); }), {"none.h5", "no such file"});
  expect_parts(message_of([&] { StoreReader in(folder.path()); }), {"is a folder"});
}

TEST(Store, TruncationAtAnyLengthIsAnErrorAndHdf5StaysSilent) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.h5";
  const Eigen::MatrixXd values = Eigen::MatrixXd::Random(100, 200);
  StoreWriter out(path, FileKind::kTrajectory);
  out.write("x", values, {"1", "x"});
  out.commit();
  const std::string whole = bytes_of(path);
  const auto cut_path = folder.path() / "cut.h5";
  testing::internal::CaptureStderr();
  for (std::size_t length = 1; length < whole.size(); length += whole.size() / 50) {
    std::ofstream(cut_path, std::ios::binary | std::ios::trunc).write(whole.data(), std::streamsize(length));
    expect_parts(message_of([&] { (void)StoreReader(cut_path).matrix("x"); }), {cut_path.string()});
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Also in files without a seal, which earlier versions wrote.
TEST(Store, FlippedBitsInLargeDataAreFound) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.h5";
  StoreWriter out(path, FileKind::kTrajectory);
  out.write("x", Eigen::MatrixXd(Eigen::MatrixXd::Random(200, 200)), {"1", "x"});
  out.commit();
  std::string bytes = bytes_of(path);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  bytes.replace(0, kSealBytes, std::string(kSealBytes, '\0'));
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  expect_parts(message_of([&] { (void)StoreReader(path).matrix("x"); }), {path.string(), "x", "damaged"});
}

TEST(Store, MissingDatasetWrongTypeAndWrongShapeAreNamed) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.h5";
  StoreWriter out(path, FileKind::kTrajectory);
  out.write("g/v", Eigen::VectorXd(Eigen::VectorXd::Zero(3)), {"1", "v"});
  out.write("g/t", std::string("text"), {"", "t"});
  out.commit();
  const StoreReader in(path);
  expect_parts(message_of([&] { (void)in.vector("g/w"); }), {path.string(), "g/w", "missing", "g holds: t, v"});
  expect_parts(message_of([&] { (void)in.vector("g/v", 4); }), {"g/v", "expected 4, found 3"});
  expect_parts(message_of([&] { (void)in.matrix("g/v", 4); }), {"g/v", "expected 4 x any, found 3"});
  expect_parts(message_of([&] { (void)in.number("g/v"); }), {"g/v", "expected a scalar, found 3"});
  expect_parts(message_of([&] { (void)in.number("g/t"); }), {"g/t", "expected a number"});
  expect_parts(message_of([&] { (void)in.text("g/v"); }), {"g/v", "expected a text"});
  expect_parts(message_of([&] { (void)in.vector("g"); }), {"g", "expected a dataset"});
}

TEST(Table, ColumnsKeepOrderUnitsAndNaN) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.h5";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Table table{"a sweep",
                    {{"speed", {"m/s", "belt speed"}, std::vector<double>{0.5, 0.4}},
                     {"failure", {"", "why not"}, std::vector<std::string>{"", "Zeno at t = 3"}},
                     {"energy", {"J", "mean energy"}, std::vector<double>{nan, 2.0}}}};
  StoreWriter out(path, FileKind::kTrajectory);
  save(out, "sweep", table);
  out.commit();
  const Table back = load_table(StoreReader(path), "sweep");
  EXPECT_EQ(back.description, "a sweep");
  ASSERT_EQ(back.columns.size(), 3U);
  EXPECT_EQ(back.columns[1].name, "failure");
  EXPECT_EQ(back.columns[0].meaning.units, "m/s");
  EXPECT_EQ(back.numbers("speed"), (std::vector<double>{0.5, 0.4}));
  EXPECT_EQ(back.texts("failure")[1], "Zeno at t = 3");
  EXPECT_TRUE(std::isnan(back.numbers("energy")[0]));
  expect_parts(message_of([&] { (void)back.numbers("nergy"); }), {"nergy", "speed, failure, energy"});
  expect_parts(message_of([&] { (void)back.numbers("failure"); }), {"failure", "holds texts"});
}

TEST(Table, UnequalColumnsAreRefused) {
  const TemporaryFolder folder;
  StoreWriter out(folder.path() / "a.h5", FileKind::kTrajectory);
  const Table table{"", {{"a", {}, std::vector<double>{1.0}}, {"b", {}, std::vector<double>{}}}};
  expect_parts(message_of([&] { save(out, "t", table); }), {"t", "column b has 0 rows", "1"});
}

TEST(Info, ListsNamesShapesUnitsAndDescriptions) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.h5";
  StoreWriter out(path, FileKind::kTrajectory);
  out.describe_group("run", "one run");
  out.write("run/q", Eigen::MatrixXd(Eigen::MatrixXd::Zero(4, 2)), {"m", "displacements"});
  out.write("run/energy", 2.5, {"J", "energy"});
  out.write("run/bad", std::numeric_limits<double>::quiet_NaN(), {"1", "no value"});
  out.write("run/law", std::string("coulomb"), {"", "the law"});
  out.commit();
  expect_parts(info(path),
               {path.string(), "run/", "one run", "q ", "4 x 2", "[m]", "displacements", "= 2.5", "[J]", "= coulomb"});
  const auto json = nlohmann::json::parse(info(path, InfoFormat::kJson));
  EXPECT_EQ(json["file"], path.string());
  ASSERT_EQ(json["contents"].size(), 5U);
  EXPECT_EQ(json["contents"][0]["kind"], "group");
  EXPECT_EQ(json["contents"][1]["name"], "run/bad");
  EXPECT_EQ(json["contents"][1]["value"], "nan");
  EXPECT_EQ(json["contents"][4]["shape"], (std::vector<int>{4, 2}));
  EXPECT_EQ(json["contents"][4]["units"], "m");
}

}  // namespace
