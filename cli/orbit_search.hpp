#pragma once

#include <slipmode/studies/orbit_search.hpp>
#include "cli/session.hpp"

#include <CLI/CLI.hpp>
#include <string>

namespace slipmode::cli {

/// What `orbit find` and `orbit continue` share.
struct OrbitSearchArguments {
  std::string scene;
  std::string model = "full";    ///< or "rom:FILE" with a result of 'slipmode reduce'
  std::string start = "settle";  ///< "settle", "initial", or the 2n numbers q1,…,qn,v1,…,vn of the full model
  studies::OrbitSearch search;   ///< guess and settles are left to search_of
};

/// SCENE and the options of a search.
void add_search_options(CLI::App& command, OrbitSearchArguments& out_arguments);

/// The search with its start read. @throws InvalidInput  for one with a wrong number of values
[[nodiscard]] studies::OrbitSearch search_of(const OrbitSearchArguments& arguments, const scene::Scene& scene);

}  // namespace slipmode::cli
