#include <slipmode/results/store.hpp>
#include <slipmode/results/table.hpp>
#include "cli/slipmode_process.hpp"
#include "fixtures/test_series.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace {

using namespace slipmode::tests;
namespace diagnostics = slipmode::diagnostics;
namespace fixtures = slipmode::fixtures;
namespace fs = std::filesystem;
namespace scene = slipmode::scene;

const std::string kChain = std::string(SLIPMODE_SOURCE_DIR) + "/datasets/chain10/scene.toml";

std::string csv(const diagnostics::Series& series, const std::string& header = "t [s],x [m]") {
  std::string text = header + "\n";
  for (Eigen::Index j = 0; j < series.values.size(); ++j) {
    text += fmt::format("{:.12g},{:.15g}\n", series.interval * static_cast<double>(j), series.values(j));
  }
  return text;
}

bool says(const Outcome& outcome, const std::string& text) { return outcome.err.find(text) != std::string::npos; }

class Diagnose : public testing::Test {
 protected:
  Outcome diagnose(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "diagnose");
    return slipmode_in(folder, arguments);
  }
  void write(const std::string& name, const std::string& text) const { write_file(folder.path() / name, text); }
  /// What the verb calls a series.
  std::string verdict(const diagnostics::Series& series) const {
    write("series.csv", csv(series));
    const Outcome outcome = diagnose({"series.csv", "--json", "--tools", "verdict"});
    return outcome.exit_code == 0 ? outcome.json()["verdict"].get<std::string>() : outcome.err;
  }
  /// Bad input: exit code 2 and a message that holds every one of `texts`.
  void expect_refusal(std::vector<std::string> arguments, const std::vector<std::string>& texts) const {
    const Outcome outcome = diagnose(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out << outcome.err;
    for (const std::string& text : texts) EXPECT_TRUE(says(outcome, text)) << text << "\n" << outcome.err;
  }

  TemporaryFolder folder;
};

TEST_F(Diagnose, TellsChaosFromNoiseFromATorusFromACycle) {
  EXPECT_EQ(verdict(fixtures::roessler(4000, 0.3)), "chaotic");
  EXPECT_EQ(verdict(fixtures::white_noise(2000, 3)), "noise");
  EXPECT_EQ(verdict(fixtures::two_torus(6000, 0.1)), "quasi-periodic");
  EXPECT_EQ(verdict(fixtures::logistic(2000, 3.7389149)), "periodic");
  EXPECT_EQ(verdict(fixtures::sine(2000, 0.1)), "periodic");
}

// One bit is ln 2 nats; a curve in the file is what the table says; every figure can be drawn from it.
TEST_F(Diagnose, GivesTheSameNumbersInTextJsonFileAndUnits) {
  write("henon.csv", csv(fixtures::henon(2000)));
  const std::vector<std::string> common = {"henon.csv:x", "--interval", "1", "--references", "500"};
  auto arguments = common;
  arguments.insert(arguments.end(), {"--json", "--unit", "nats", "-o", "henon.h5", "--figures", "figures"});
  const Outcome nats = diagnose(arguments);
  ASSERT_EQ(nats.exit_code, 0) << nats.err;
  arguments = common;
  arguments.insert(arguments.end(), {"--json", "--tools", "jacobians,wolf"});
  const Outcome bits = diagnose(arguments);
  ASSERT_EQ(bits.exit_code, 0) << bits.err;
  for (const std::string key : {"jacobians_1", "wolf"}) {
    EXPECT_NEAR(bits.json()["findings"][key]["value"].get<double>() * std::numbers::ln2,
                nats.json()["findings"][key]["value"].get<double>(), 1e-12);
  }
  // Accepted value 0.4192 per step; the tool's own band at 20,000 samples is 0.02, at 2,000 three times that.
  EXPECT_NEAR(nats.json()["findings"]["jacobians_1"]["value"].get<double>(), 0.4192, 0.06);
  const results::StoreReader store(folder.path() / "henon.h5");
  EXPECT_EQ(store.text("diagnosis/verdict"), nats.json()["verdict"]);
  const results::Table exponents = results::load_table(store, "diagnosis/exponents");
  EXPECT_EQ(exponents.numbers("exponent")[0], nats.json()["findings"]["jacobians_1"]["value"].get<double>());
  EXPECT_EQ(store.vector("diagnosis/series/values").size(), 2000);
  const std::vector<std::string> figures = nats.json()["figures"];
  for (const std::string& figure : figures) {
    for (const std::string extension : {".svg", ".png"}) {
      EXPECT_TRUE(is_figure(folder.path() / "figures" / (figure + extension))) << figure;
    }
  }
  ASSERT_EQ(slipmode_in(folder, {"plot", "henon.h5", "--figure", "recurrence", "-o", "r.svg"}).exit_code, 0);
  EXPECT_EQ(slipmode_in(folder, {"info", "henon.h5"}).exit_code, 0);
}

TEST_F(Diagnose, HasTheSameBytesForAnyNumberOfThreads) {
  write("l.csv", csv(fixtures::lorenz(2500, 0.05)));
  ASSERT_EQ(diagnose({"l.csv", "--references", "500", "--threads", "1", "-o", "one.h5"}).exit_code, 0);
  ASSERT_EQ(diagnose({"l.csv", "--references", "500", "--threads", "3", "-o", "three.h5"}).exit_code, 0);
  EXPECT_EQ(bytes_of(folder.path() / "one.h5"), bytes_of(folder.path() / "three.h5"));
}

// The chain's contact is at mass 10: mass 1 is farthest. S4 section 3.2 takes its velocity.
TEST_F(Diagnose, TakesTheVelocityFarthestFromTheContactsAndWarnsOfTheOthers) {
  ASSERT_EQ(
      slipmode_in(folder, {"simulate", kChain, "--single", "--set", "time.duration=23000.0", "-o", "run.h5"}).exit_code,
      0);
  const std::vector<std::string> quick = {"--json", "--tools", "information", "--delay", "3", "--dimension", "3"};
  const auto on = [&](const std::string& series) {
    std::vector<std::string> arguments = {series};
    arguments.insert(arguments.end(), quick.begin(), quick.end());
    const Outcome outcome = diagnose(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.json();
  };
  const auto usual = on("run.h5");
  EXPECT_EQ(usual["series"], "run.h5:trajectory/v/1");
  EXPECT_NE(usual["what"].get<std::string>().find("farthest from the contacts"), std::string::npos);
  EXPECT_EQ(usual["findings"], on("run.h5:v/x1")["findings"]);
  EXPECT_EQ(on("run.h5:trajectory/v/1")["findings"], on("run.h5:v/1")["findings"]);
  // Half a unit of time between samples; the mass on the belt sticks more than half of the time.
  const auto rubbed = on("run.h5:v/10");
  EXPECT_GT(rubbed["findings"]["flat_share"]["value"], 20.0);
  ASSERT_EQ(rubbed["warnings"].size(), 1U);
  EXPECT_NE(rubbed["warnings"][0].get<std::string>().find("run.h5:trajectory/v/1"), std::string::npos);
  const auto half =
      diagnose({"run.h5", "--every", "2", "--from", "21000", "--to", "22000", "--json", "--tools", "autocorrelation"});
  EXPECT_EQ(half.json()["findings"]["samples"]["value"], 1001.0);
  expect_refusal({"run.h5:v/0"}, {"columns 1 to 10", "'0'"});
  expect_refusal({"run.h5:w/1"}, {"no record 'w/1'", "trajectory/v"});
  expect_refusal({"run.h5", "--dimension", "60", "--delay", "110"}, {"dimension 60", "at least", "found 6001"});
}

TEST_F(Diagnose, ReadsColumnsUnitsAndOtherSeparators) {
  write("two.csv", "# measured\r\nt [ms];a (m/s);b\r\n0;1,5;0\r\n2;2,5;1\r\n4;1,5;0\r\n");
  std::string text = "\xEF\xBB\xBFTime\tx\n";
  const auto sine = fixtures::sine(1500, 0.1);
  for (Eigen::Index j = 0; j < 1500; ++j)
    text += fmt::format("{}\t{:+.9f}\n", 0.1 * static_cast<double>(j), sine.values(j));
  write("tabs.csv", text);
  const Outcome outcome = diagnose({"tabs.csv", "--json", "--tools", "spectrum"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["series"], "tabs.csv:x");
  const auto peak = outcome.json()["findings"]["peak"];
  EXPECT_NEAR(peak["value"].get<double>(), 0.5 / std::numbers::pi, peak["error"].get<double>());
  expect_refusal({"two.csv"}, {"2 columns", "two.csv:a", "two.csv:b"});
  expect_refusal({"two.csv:c"}, {"no column 'c'", "a (2)", "b (3)"});
  expect_refusal({"two.csv:a"}, {"at least 100 samples, found 3"});
}

TEST_F(Diagnose, RefusesBadRecordsAndSaysWhere) {
  const auto with = [&](const std::string& name, Eigen::Index row, const std::string& line) {
    std::string text = "t,x\n";
    for (Eigen::Index j = 0; j < 500; ++j) {
      const double t = 0.1 * static_cast<double>(j);
      text += j == row ? line : fmt::format("{:.10g},{:.10g}\n", t, std::sin(t));
    }
    write(name, text);
    return name;
  };
  expect_refusal({with("nan.csv", 41, "4.1,nan\n")}, {"line 43", "--from"});
  expect_refusal({with("empty.csv", 41, "4.1,\n")}, {"line 43", "--from"});
  expect_refusal({with("word.csv", 41, "4.1,high\n")}, {"line 43", "'high'"});
  expect_refusal({with("short.csv", 41, "4.1\n")}, {"line 43", "expected 2 cells"});
  expect_refusal({with("gap.csv", 41, "")}, {"between samples 40 and 41", "gap of about 1", "line 2"});
  expect_refusal({with("late.csv", 41, "4.14,0.1\n")}, {"equal intervals of 0.1", "between samples 40 and 41"});
  EXPECT_EQ(diagnose({"gap.csv", "--from", "4.15", "--tools", "spectrum"}).exit_code, 0);
  write(
      "flat.csv", "t,x\n" + [] {
        std::string rows;
        for (int j = 0; j < 500; ++j) rows += fmt::format("{},3\n", j);
        return rows;
      }());
  expect_refusal({"flat.csv"}, {"samples that vary", "found 3"});
  write("bare.csv", "1,2\n3,4\n");
  expect_refusal({"bare.csv"}, {"header", "line 1"});
  write("only.csv", "t,x\n");
  expect_refusal({"only.csv"}, {"found 0"});
  write("no_time.csv", "x\n1\n2\n");
  expect_refusal({"no_time.csv"}, {"--time", "--interval"});
  write("bytes.bin", std::string("\x7f\0\1\2", 4));
  expect_refusal({"bytes.bin"}, {"neither HDF5 nor text"});
  write("empty_file.csv", "");
  expect_refusal({"empty_file.csv"}, {"empty"});
  expect_refusal({"absent.h5:v"}, {"no such file"});
  expect_refusal({"nan.csv", "--delay", "-3"}, {"--delay"});
  expect_refusal({"nan.csv", "--tools", "wulf"}, {"no such tool", "wolf"});
  expect_refusal({"nan.csv", "--unit", "trits"}, {"--unit"});
  expect_refusal({"nan.csv", "-o", "nowhere/out.h5"}, {"folder nowhere does not exist"});
}

}  // namespace
