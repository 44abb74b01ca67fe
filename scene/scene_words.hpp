#pragma once

// Internal to scene/: the words of a scene file, used both to read and to write it.

#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace slipmode::scene {

inline const std::vector<std::string> kUnits = {"dimensionless", "SI"};

struct Ends {
  const char* word;
  bool left_fixed, right_fixed;
};
inline constexpr std::array<Ends, 4> kEnds = {{{"fixed-free", true, false},
                                               {"free-fixed", false, true},
                                               {"fixed-fixed", true, true},
                                               {"free-free", false, false}}};

/// In the order of friction::Law's alternatives.
struct LawWord {
  enum Law { kCoulomb, kStribeck, kTanh };
  const char* word;
  Law law;
};
inline constexpr std::array<LawWord, 3> kLaws = {
    {{"coulomb", LawWord::kCoulomb}, {"stribeck", LawWord::kStribeck}, {"tanh", LawWord::kTanh}}};

struct StartWord {
  const char* word;
  InitialSpec::At at;
};
inline constexpr std::array<StartWord, 2> kStarts = {
    {{"rest", InitialSpec::At::kRest}, {"static", InitialSpec::At::kStatic}}};

struct BasisWord {
  const char* word;
  pod::BasisKind kind;
};
inline constexpr std::array<BasisWord, 2> kBases = {{{"pom", pod::BasisKind::kPom}, {"lnm", pod::BasisKind::kLnm}}};

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
