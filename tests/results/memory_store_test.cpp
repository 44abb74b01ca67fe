// A result in memory beside the file it stands for.

#include <slipmode/core/errors.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/results/records.hpp>
#include "scene/messages.hpp"
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <memory>

namespace slipmode::results {
namespace {

using slipmode::tests::bytes_of;
using slipmode::tests::expect_parts;
using slipmode::tests::message_of;
using slipmode::tests::TemporaryFolder;

/// Every kind of dataset, in a dimensionless scene; `large` shares its memory.
Content some_content(const std::shared_ptr<const Eigen::MatrixXd>& large) {
  const auto write = [large](StoreWriter& writer) {
    writer.describe_group("g", "a group");
    writer.write_columns("g/large", *large, {"m", "time x dof"});
    writer.write("g/small", Eigen::MatrixXd(large->topLeftCorner(2, 3)), {"m/s", "rows"});
    writer.write("g/h/number", 0.1, {"s", "a number"});
    writer.write("g/h/clock", 0.2, {"s", "a time", Meaning::Of::kClock});
    writer.write("integers", std::vector<std::int64_t>{3, -1}, {"", "integers"});
    writer.write("texts", std::vector<std::string>{"one", "", "three"}, {"", "texts"});
    writer.write("empty", std::vector<double>{}, {"1", "nothing"});
  };
  return {.kind = FileKind::kPod,
          .unit_system = "dimensionless",
          .write = write,
          .shared = {{large, {large->data(), static_cast<std::size_t>(large->size())}}}};
}

std::shared_ptr<const Eigen::MatrixXd> some_numbers() {
  return std::make_shared<const Eigen::MatrixXd>(Eigen::MatrixXd::Random(7, 2000));
}

// Expected: the bytes of the file written without the detour.
TEST(MemoryStore, SavesTheFileItStandsFor) {
  const TemporaryFolder folder;
  const Content content = some_content(some_numbers());
  content.save(folder.path() / "file.h5");
  const MemoryStore store(content);
  store.save(folder.path() / "memory.h5");
  EXPECT_EQ(bytes_of(folder.path() / "memory.h5"), bytes_of(folder.path() / "file.h5"));
  // Read back a file has its names sorted, and the same in each.
  const MemoryStore read(StoreReader(folder.path() / "file.h5"));
  EXPECT_EQ(read.kind(), "pod");
  for (const Dataset& dataset : store.datasets()) {
    const Dataset* same = read.find(dataset.name);
    ASSERT_NE(same, nullptr) << dataset.name;
    EXPECT_EQ(same->shape, dataset.shape) << dataset.name;
    EXPECT_EQ(same->meaning.units, dataset.meaning.units) << dataset.name;
    EXPECT_EQ(same->texts, dataset.texts) << dataset.name;
    for (std::size_t i = 0; dataset.numbers && i < dataset.count(); ++i)
      ASSERT_EQ(same->numbers.get()[i], dataset.numbers.get()[i]) << dataset.name;
  }
  EXPECT_EQ(read.find("g/large")->meaning.units, "1");
  EXPECT_EQ(read.find("g/h/clock")->meaning.units, "s");
}

TEST(MemoryStore, SharesWhatItsResultOwnsAndCopiesTheRest) {
  const auto numbers = some_numbers();
  const double* const begin = numbers->data();
  auto store = std::make_unique<MemoryStore>(some_content(numbers));
  const std::shared_ptr<const double> shared = store->find("g/large")->numbers;
  EXPECT_EQ(shared.get(), begin);
  EXPECT_NE(store->find("g/small")->numbers.get(), begin);
  store.reset();
  EXPECT_EQ(numbers.use_count(), 2);  // this one and the dataset's
}

// Expected: what a reader of the file says, also of what is not there.
TEST(MemoryStore, ReadsAsItsFileDoes) {
  const TemporaryFolder folder;
  const Content content = some_content(some_numbers());
  content.save(folder.path() / "file.h5");
  const StoreReader file(folder.path() / "file.h5"), memory(std::make_shared<const MemoryStore>(content));
  EXPECT_EQ(kind_of(memory), FileKind::kPod);
  for (const char* group : {"", "g", "g/h"}) EXPECT_EQ(memory.names(group), file.names(group));
  EXPECT_EQ(memory.columns("g/large"), file.columns("g/large"));
  EXPECT_EQ(memory.matrix("g/small", 2, 3), file.matrix("g/small", 2, 3));
  EXPECT_EQ(memory.vector("integers"), file.vector("integers"));
  EXPECT_EQ(memory.integers("integers", 2), file.integers("integers", 2));
  EXPECT_EQ(memory.texts("texts"), file.texts("texts"));
  EXPECT_EQ(memory.number("g/h/number"), 0.1);
  EXPECT_EQ(memory.entries().size(), file.entries().size());
  EXPECT_TRUE(memory.has("g/h"));
  EXPECT_FALSE(memory.has("g/hh"));
  expect_parts(message_of([&] { (void)memory.number("g/none"); }), {"pod: g/none: missing", "h, large"});
  expect_parts(message_of([&] { (void)memory.number("texts"); }), {"expected a number"});
  expect_parts(message_of([&] { (void)memory.vector("integers", 3); }), {"expected 3, found 2"});
  expect_parts(message_of([&] { (void)memory.text("g"); }), {"g: is a group"});
}

TEST(MemoryStore, RefusesANameTwice) {
  const Content twice{.kind = FileKind::kPod, .unit_system = "SI", .write = [](StoreWriter& writer) {
                        writer.write("a", 1.0, {"1", ""});
                        writer.write("a", 2.0, {"1", ""});
                      }};
  expect_parts(message_of([&] { MemoryStore{twice}; }), {"a: written twice"});
}

}  // namespace
}  // namespace slipmode::results
