#include "bench/cases.hpp"

#include "bench/machine.hpp"

namespace slipmode::bench {

std::vector<ComparisonCase> comparison_cases(bool quick) {
  const ChainProblem ten{.name = "stribeck10"};
  const auto at_speed = [&](const char* name, double belt) {
    ChainProblem problem = ten;
    problem.name = name;
    problem.belt = belt;
    return ComparisonCase{.problem = problem, .wanted_odeint = 40.0};
  };
  std::vector<ComparisonCase> cases;
  cases.push_back({.problem = ten, .wanted_cvode = 300.0, .wanted_odeint = 18.0});
  cases.push_back(at_speed("stribeck10-v0.45", 0.45));
  cases.push_back(at_speed("stribeck10-v0.41", 0.41));
  cases.push_back(at_speed("stribeck10-v0.05", 0.05));

  ChainProblem coulomb = ten;
  coulomb.name = "coulomb10";
  coulomb.coulomb = true;
  cases.push_back({.problem = coulomb, .wanted_cvode = 2000.0, .wanted_odeint = 120.0});

  ChainProblem hundred = ten;
  hundred.name = "stribeck100";
  hundred.n = 100;
  cases.push_back({.problem = hundred, .wanted_cvode = 1000.0, .wanted_odeint = 40.0, .repeats = 6});

  ChainProblem rich = hundred;
  rich.name = "stribeck100-ground";
  rich.ground = 0.25;
  cases.push_back({.problem = rich, .wanted_odeint = 40.0, .repeats = 3});

  ChainProblem thousand = ten;
  thousand.name = "stribeck1000";
  thousand.n = 1000;
  thousand.ground = 0.25;
  cases.push_back({.problem = thousand,
                   .transient = 500.0,
                   .peer_duration = 2000.0,
                   .stretches = 5,
                   .wanted_cvode = 500.0,
                   .wanted_odeint = 40.0,
                   .repeats = 3,
                   .setup_counts = true});
  for (ComparisonCase& c : cases) {
    c.wanted_cvode *= wanted_share();
    c.wanted_odeint *= wanted_share();
  }
  if (quick) {
    for (ComparisonCase& c : cases) {
      c.duration *= 0.1;
      c.peer_duration *= 0.1;
      c.stretches = 5;
      c.repeats = 3;
    }
  }
  return cases;
}

}  // namespace slipmode::bench
