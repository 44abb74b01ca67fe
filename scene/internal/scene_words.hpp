#pragma once

// The words of a scene file, used both to read and to write it.

#include <slipmode/scene/scene.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace slipmode::scene {

inline const std::vector<std::string> kUnits = {"dimensionless", "SI"};

/// In the order of StructureSpec's alternatives.
inline const std::vector<std::string> kStructures = {"chain", "beam", "masses", "matrices"};

struct Ends {
  const char* word;
  bool left_fixed, right_fixed;
};
inline constexpr std::array<Ends, 4> kEnds = {{{"fixed-free", true, false},
                                               {"free-fixed", false, true},
                                               {"fixed-fixed", true, true},
                                               {"free-free", false, false}}};

struct TheoryWord {
  const char* word;
  fem::BeamTheory theory;
};
inline constexpr std::array<TheoryWord, 2> kTheories = {
    {{"euler-bernoulli", fem::BeamTheory::kEulerBernoulli}, {"timoshenko", fem::BeamTheory::kTimoshenko}}};

struct SensorWord {
  const char* word;
  pod::SensorKind kind;
};
inline constexpr std::array<SensorWord, 2> kSensors = {
    {{"strain", pod::SensorKind::kStrain}, {"displacement", pod::SensorKind::kDisplacement}}};

struct FitWord {
  const char* word;
  pod::FitFamily family;
};
inline constexpr std::array<FitWord, 2> kFits = {
    {{"modes", pod::FitFamily::kNaturalModes}, {"polynomial", pod::FitFamily::kPolynomials}}};

struct FollowWord {
  const char* word;
  ShakenValidationSpec::Follow follow;
};
inline constexpr std::array<FollowWord, 3> kFollows = {{{"none", ShakenValidationSpec::Follow::kNone},
                                                        {"forward", ShakenValidationSpec::Follow::kForward},
                                                        {"both", ShakenValidationSpec::Follow::kBoth}}};

struct StartWord {
  const char* word;
  InitialSpec::At at;
};
inline constexpr std::array<StartWord, 2> kStarts = {
    {{"rest", InitialSpec::At::kRest}, {"static", InitialSpec::At::kStatic}}};

/// In the order of BasisChoice; the first two are a chain's.
inline const std::vector<std::string> kBases = {"pom", "lnm", "pomf", "mass-pom", "lnm+static"};
inline constexpr std::size_t kChainBases = 2;

struct MethodWord {
  const char* word;
  dynamics::FlowMethod method;
};
inline constexpr std::array<MethodWord, 3> kMethods = {{{"automatic", dynamics::FlowMethod::kAutomatic},
                                                        {"closed-form", dynamics::FlowMethod::kClosedForm},
                                                        {"collocation", dynamics::FlowMethod::kCollocation}}};

/// The words of a list of entries that each have one.
template <class List>
std::vector<std::string> words_of(const List& list) {
  std::vector<std::string> words;
  for (const auto& entry : list) words.emplace_back(entry.word);
  return words;
}

}  // namespace slipmode::scene
