#include "report/internal/json.hpp"
#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include "report/internal/structure.hpp"

namespace {

using namespace slipmode;
using report::Json;

/// The numbers a list stands for, as page/main.js reads them.
std::vector<double> read(const Json& list) {
  if (list.is_array()) return list.get<std::vector<double>>();
  std::vector<double> out;
  std::int64_t at = 0;
  for (const Json& difference : list["d"]) {
    if (difference.is_null()) {
      out.push_back(std::nan(""));
      continue;
    }
    at += difference.get<std::int64_t>();
    const double value = list["low"].get<double>() + static_cast<double>(at) * list["step"].get<double>();
    out.push_back(list.contains("log") ? std::pow(10.0, value) : value);
  }
  return out;
}

// Rounding to the nearest step leaves half a step: 1/20000 of the span, coarse 1/4000.
TEST(ReportLists, AreWithinHalfAStepOfTheSpan) {
  Eigen::VectorXd values(1000);
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = -3.0 + 8.0 * std::sin(0.1 * static_cast<double>(i));
  const double span = values.maxCoeff() - values.minCoeff();
  for (const auto& [grain, half] :
       {std::pair(report::Grain::kFine, span / 20000.0), std::pair(report::Grain::kCoarse, span / 4000.0)}) {
    const std::vector<double> back = read(report::list_json(values, grain));
    ASSERT_EQ(back.size(), 1000U);
    for (Eigen::Index i = 0; i < values.size(); ++i)
      EXPECT_NEAR(back[static_cast<std::size_t>(i)], values[i], half * (1.0 + 1e-9));
  }
}

// Over eight decades half a step is a factor of 10^(8/20000): 0.092 %.
TEST(ReportLists, OfALogarithmicAxisKeepSmallValues) {
  Eigen::VectorXd values(200);
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = std::pow(10.0, -8.0 * static_cast<double>(i) / 199.0);
  const std::vector<double> back = read(report::list_json(values, report::Grain::kFine, true));
  for (Eigen::Index i = 0; i < values.size(); ++i)
    EXPECT_NEAR(back[static_cast<std::size_t>(i)] / values[i], 1.0, 9.3e-4);
}

TEST(ReportLists, KeepHolesWhereAValueIsNotFinite) {
  Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(100, 0.0, 99.0);
  values[40] = std::numeric_limits<double>::quiet_NaN();
  values[41] = std::numeric_limits<double>::infinity();
  const std::vector<double> back = read(report::list_json(values));
  EXPECT_TRUE(std::isnan(back[40]));
  EXPECT_TRUE(std::isnan(back[41]));
  EXPECT_NEAR(back[42], 42.0, 0.005);
}

TEST(ReportLists, OfShortListsAreTheNumbersThemselves) {
  const Json list = report::list_json(Eigen::Vector3d(0.1, -2.5e-7, 3.0));
  EXPECT_EQ(list, Json({0.1, -2.5e-7, 3.0}));
  EXPECT_TRUE(report::number_json(std::nan("")).is_null());
}

dynamics::Event event(double time, int contact, dynamics::ContactMode before, dynamics::ContactMode after) {
  dynamics::Event out;
  out.time = time;
  out.contact = contact;
  out.before = before;
  out.after = after;
  return out;
}

TEST(ReportContactModes, AreThoseOfTheEvents) {
  using enum dynamics::ContactMode;
  const std::vector<dynamics::Event> events = {event(9.0, 0, kStick, kSlipPositive),
                                               event(10.5, 0, kSlipPositive, kStick), event(11.0, 1, kGap, kLeftStop),
                                               event(12.0, 0, kStick, kSlipNegative)};
  // Contact 0 slips at 10, as its event at 9 left it; contact 1 is in the gap until 11; contact 2 never changes.
  EXPECT_EQ(report::contact_modes_json(events, {kSlipNegative, kLeftStop, kStick}, 10.0),
            Json::parse("[[[0.0, 1], [0.5, 0], [2.0, -1]], [[0.0, 4], [1.0, 5]], [[0.0, 0]]]"));
}

TEST(ReportStructure, ReadsTheDegreesOfFreedomItDraws) {
  const auto scene = scene::parse_scene(R"(
title = "long"
units = "SI"
[structure]
kind = "chain"
masses = 100
[[contact]]
at = 37
law = "coulomb"
mu_s = 0.4
mu_k = 0.2
normal_load = 1.0
[drive]
kind = "belt"
speed = 0.1
[time]
duration = 10.0
)");
  const report::DrawnStructure drawn = report::drawn_structure(scene);
  const Eigen::VectorXd masses = Eigen::VectorXd::LinSpaced(100, 1.0, 100.0);
  const Eigen::VectorXd read = drawn.readings * masses;  // displaced by its number each mass tells which it is
  const std::vector<double> x = drawn.about["x"].get<std::vector<double>>();
  ASSERT_EQ(static_cast<std::size_t>(read.size()), x.size());
  for (Eigen::Index i = 0; i < read.size(); ++i) EXPECT_EQ(read[i], x[static_cast<std::size_t>(i)]);
  EXPECT_EQ(x.front(), 1.0);
  EXPECT_EQ(x.back(), 100.0);
  EXPECT_NE(std::find(x.begin(), x.end(), 37.0), x.end()) << "the mass at the contact";
  EXPECT_LE(x.size(), 25U);
}

}  // namespace
