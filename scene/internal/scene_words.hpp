#pragma once

// The words of a scene file, used both to read and to write it.

#include <slipmode/scene/scene.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <vector>

namespace slipmode::scene {

inline const std::vector<std::string> kUnits = {"dimensionless", "SI"};

/// In the order of StructureSpec's alternatives.
inline const std::vector<std::string> kStructures = {"chain", "beam", "masses", "matrices"};

inline const std::vector<std::string> kDrives = {"belt", "shaker", "force"};

/// Of a chain, the left one first.
inline const std::vector<std::string> kEnds = {"fixed-free", "free-fixed", "fixed-fixed", "free-free"};

/// How many of BasisChoice, the first, are a chain's too.
inline constexpr std::size_t kChainBases = 2;

}  // namespace slipmode::scene

namespace slipmode {

template <>
inline constexpr std::array kWords<fem::BeamTheory> = {"euler-bernoulli", "timoshenko"};
template <>
inline constexpr std::array kWords<pod::SensorKind> = {"strain", "displacement"};
template <>
inline constexpr std::array kWords<pod::FitFamily> = {"modes", "polynomial"};
template <>
inline constexpr std::array kWords<scene::DrivenValidationSpec::Follow> = {"none", "forward", "both"};
template <>
inline constexpr std::array kWords<scene::InitialSpec::At> = {"rest", "static"};
template <>
inline constexpr std::array kWords<scene::BasisChoice> = {"pom", "lnm", "pomf", "mass-pom", "lnm+static"};
template <>
inline constexpr std::array kWords<dynamics::FlowMethod> = {"automatic", "closed-form", "collocation"};

template <>
inline constexpr auto kFields<fem::Rayleigh> =
    std::tuple{required("coefficient", &fem::Rayleigh::stiffness, "s", "C = coefficient K", kNonNegative),
               optional("mass_coefficient", &fem::Rayleigh::mass, "1/s", "C += mass_coefficient M", kNonNegative)};
template <>
inline constexpr auto kFields<dynamics::FlowOptions> = std::tuple{
    optional("method", &dynamics::FlowOptions::method, "", "how the flow is computed"),
    optional("tolerance", &dynamics::FlowOptions::tolerance, "1", "bound on the error of a step",
             {.low = 0.0, .high = 1.0, .above = true, .text = "a number > 0 and <= 1"}),
    optional("certify", &dynamics::FlowOptions::certify, "", "prove step by step that no event is passed"),
    optional("max_events_per_window", &dynamics::FlowOptions::max_events_per_window, "", "more is Zeno", kCount),
    optional("zeno_window", &dynamics::FlowOptions::zeno_window, "s", "in which these are counted; 0: chosen",
             kNonNegative)};

}  // namespace slipmode
