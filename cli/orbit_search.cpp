#include "cli/orbit_search.hpp"

#include <slipmode/core/numbers.hpp>
#include "cli/field_options.hpp"

#include <fmt/format.h>
#include <cmath>
#include <vector>

namespace slipmode::cli {
namespace {

std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const auto value = number_in<double>(word);
    if (!value || !std::isfinite(*value)) {
      throw InvalidInput(
          fmt::format("--start {}: '{}' is no number; valid: settle, initial, or q1,...,qn,v1,...,vn", text, word));
    }
    numbers.push_back(*value);
    begin = end + 1;
  }
  return numbers;
}

dynamics::State given_state(const std::string& text, Eigen::Index n) {
  const std::vector<double> numbers = numbers_of(text);
  if (static_cast<Eigen::Index>(numbers.size()) != 2 * n) {
    throw InvalidInput(
        fmt::format("--start: {} values for {} degrees of freedom; expected {}: displacements, then "
                    "velocities",
                    numbers.size(), n, 2 * n));
  }
  const Eigen::Map<const Eigen::VectorXd> x(numbers.data(), 2 * n);
  return {.q = x.head(n), .v = x.tail(n)};
}

}  // namespace

void add_search_options(CLI::App& command, OrbitSearchArguments& out_arguments) {
  command.add_option("SCENE", out_arguments.scene, "scene file (TOML)")->required();
  command.add_option("--model", out_arguments.model,
                     "full, or rom:FILE with a result of 'slipmode reduce'; under a shaker also BASIS:L, e.g. pomf:3");
  command.add_option("--start", out_arguments.start,
                     "where Newton's method begins: settle (a run from [initial]), initial, or q1,...,qn,v1,...,vn");
  add_fields(command, out_arguments.search);
}

studies::OrbitSearch search_of(const OrbitSearchArguments& arguments, const scene::Scene& scene) {
  studies::OrbitSearch search = arguments.search;
  search.settles = arguments.start == "settle";
  if (!search.settles && arguments.start != "initial") search.guess = given_state(arguments.start, scene.size());
  return search;
}

}  // namespace slipmode::cli
