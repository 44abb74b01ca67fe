// What datasets/README.md says of scene files against the field lists they are read by.
#include <slipmode/scene/scene.hpp>
#include "scene/internal/scene_words.hpp"

#include <gtest/gtest.h>
#include <fstream>
#include <regex>
#include <sstream>

namespace {

using namespace slipmode;

/// The part of the page that lists the keys.
std::string key_tables() {
  std::ifstream in(SLIPMODE_SOURCE_DIR "/datasets/README.md");
  std::stringstream text;
  text << in.rdbuf();
  return text.str().substr(text.str().find("## scene.toml"));
}

void expect_named(const std::string& tables, const std::string& word) {
  EXPECT_TRUE(std::regex_search(tables, std::regex("\\b" + word + "\\b"))) << word;
}

template <class... S>
void expect_keys_named(const std::string& tables) {
  (for_each_field<S>([&](const auto& field) { expect_named(tables, field.name); }), ...);
}

template <class... Laws>
void expect_laws_named(const std::string& tables, const std::variant<Laws...>& /*any*/) {
  expect_keys_named<Laws...>(tables);
  for (const std::string& word : friction::law_words()) expect_named(tables, word);
}

TEST(SceneKeys, OfEveryFieldListAreInTheReadme) {
  const std::string tables = key_tables();
  expect_laws_named(tables, friction::Law());
  expect_keys_named<friction::Stop, friction::NormalLoad, friction::NormalOscillator, friction::Belt, friction::Shaker,
                    friction::AmplitudeCurve::Exponential>(tables);
  expect_keys_named<fem::ChainOptions, fem::MassesOptions, fem::Link, fem::BeamOptions, fem::BeamSpan, fem::TipBody,
                    fem::Rayleigh, fem::ModalRatios>(tables);
  expect_keys_named<scene::ForceSpec::Harmonic, scene::TimeSpec, scene::TimeSpec::Cycles, scene::InitialSpec,
                    scene::EnsembleSpec, scene::SensorSpec, scene::ReductionSpec, pod::ModeChoice, scene::Range,
                    scene::ValidationSpec, scene::DrivenValidationSpec, dynamics::FlowOptions>(tables);
}

}  // namespace
