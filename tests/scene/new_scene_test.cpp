#include <slipmode/scene/new_scene.hpp>

#include <slipmode/scene/schema.hpp>
#include "scene/messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace slipmode::scene {
namespace {

using testing::HasSubstr;
using tests::expect_parts;
using tests::message_of;

/// Characters of a line of UTF-8.
std::size_t width(const std::string& line) {
  return static_cast<std::size_t>(
      std::count_if(line.begin(), line.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

TEST(NewScene, OfEachKindIsASceneInLinesOf80) {
  for (const std::string& kind : new_scene_kinds()) {
    const std::string text = new_scene(kind, "mine.toml");
    const Scene scene = parse_scene(text);
    EXPECT_EQ(scene.units, "SI") << kind;
    EXPECT_THAT(text, HasSubstr("slipmode run mine.toml -o out")) << kind;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(width(line), 80U) << line;
  }
}

// The field list of the chain says "one, or one per spring" and N/m, and what else there is.
TEST(NewScene, SaysWhatTheFieldListsSay) {
  const std::string chain = new_scene("chain", "s.toml");
  EXPECT_THAT(chain, HasSubstr("# one, or one per spring [N/m]\n"));
  EXPECT_THAT(chain, HasSubstr("# also: ground_stiffness, mass_damping\n"));
  const std::string beam = new_scene("beam", "s.toml");
  EXPECT_THAT(beam, HasSubstr("# Young's modulus [Pa]\n"));
  EXPECT_THAT(beam, HasSubstr("pom, lnm, pomf, mass-pom, lnm+static\n")) << "the words of a basis";
  EXPECT_THAT(beam, testing::Not(HasSubstr("lyapunov_duration"))) << "a belt's";
}

TEST(NewScene, OfAnotherKindIsRefused) {
  expect_parts(message_of([] { (void)new_scene("chian", "s.toml"); }), {"chian", "chain, beam, matrices, clearance"});
}

// Draft 7: "exclusiveMinimum" is a number.
TEST(SceneSchema, HasLimitsDefaultsWordsAndUnitsOfTheFieldLists) {
  const auto schema = nlohmann::json::parse(scene_schema());
  EXPECT_EQ(schema["required"], nlohmann::json({"units", "structure", "contact", "drive"}));
  const auto& chain = schema["properties"]["structure"]["anyOf"][0]["properties"];
  EXPECT_EQ(chain["kind"]["const"], "chain");
  EXPECT_EQ(chain["masses"]["maximum"], 1e7);
  EXPECT_EQ(chain["damping"]["minimum"], 0.0);
  EXPECT_EQ(chain["damping"]["description"], "C = damping K [s]");
  EXPECT_EQ(chain["mass"]["default"], 1.0);
  EXPECT_EQ(schema["properties"]["flow"]["properties"]["method"]["enum"],
            nlohmann::json({"automatic", "closed-form", "collocation"}));
  EXPECT_EQ(schema["properties"]["flow"]["properties"]["tolerance"]["exclusiveMinimum"], 0.0);
}

}  // namespace
}  // namespace slipmode::scene
