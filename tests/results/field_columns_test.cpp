#include "results/internal/field_record.hpp"
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <cmath>

namespace slipmode::results {
namespace {

struct Timed {
  int runs = 0;
  double wall = 0.0;
  std::string name;

  static constexpr auto fields() {
    return std::tuple{required("runs", &Timed::runs, "", "how many"),
                      required("wall_s", &Timed::wall, kClockSeconds, "time of the clock").stored_as("wall"),
                      required("name", &Timed::name, "", "which")};
  }
};

struct Row {
  bool is_there = true;
  Timed timed;
};

TEST(FieldColumns, AreOnePerFieldUnderItsStoredName) {
  const std::vector<Timed> rows = {{2, 0.5, "a"}, {3, 0.25, "b"}};
  const Table table{"timed", joined({{{"case", {}, std::vector<double>{1.0, 2.0}}}, columns_of(rows)})};
  ASSERT_EQ(table.columns.size(), 4U);
  EXPECT_EQ(table.numbers("runs"), (std::vector<double>{2.0, 3.0}));
  EXPECT_EQ(table.numbers("wall"), (std::vector<double>{0.5, 0.25}));
  EXPECT_EQ(table.texts("name"), (std::vector<std::string>{"a", "b"}));
}

TEST(FieldColumns, ARowWithoutTheStructHasNoNumbers) {
  const std::vector<Row> rows = {{true, {1, 0.5, "a"}}, {false, {}}};
  const std::vector<Column> columns =
      columns_of(rows, [](const Row& row) { return row.is_there ? &row.timed : nullptr; });
  EXPECT_TRUE(std::isnan(std::get<std::vector<double>>(columns[1].values)[1]));
  EXPECT_EQ(std::get<std::vector<std::string>>(columns[2].values)[1], "");
}

// A dimensionless scene has no seconds, but a clock has.
TEST(FieldColumns, SecondsOfAClockStaySeconds) {
  const tests::TemporaryFolder folder;
  StoreWriter out(folder.path() / "a.h5", FileKind::kTrade, "dimensionless");
  save_fields(out, "timed", Timed{});
  out.commit();
  EXPECT_EQ(StoreReader(folder.path() / "a.h5").entry("timed/wall").meaning.units, "s");
}

}  // namespace
}  // namespace slipmode::results
