#include "selftest/scene_draft.hpp"

#include <algorithm>
#include <numbers>

namespace slipmode::selftest {
namespace {

void chain(SceneDraft& d, int masses) {
  d.dofs = masses;
  const bool left = masses == 1 || d.chance(0.8), right = d.chance(0.2), grounded = d.chance(0.3);
  d.floats = !left && !right && !grounded;
  d.line("kind = \"chain\"\nmasses = {}\nends = \"{}\"", masses,
         left && right ? "fixed-fixed"
         : left        ? "fixed-free"
         : right       ? "free-fixed"
                       : "free-free");
  d.line("mass = {}", SceneDraft::numbers(d.masses_of(masses)));
  std::vector<double> springs;
  for (int i = 0; i < masses - 1 + (left ? 1 : 0) + (right ? 1 : 0); ++i) springs.push_back(d.spring(0.3, 3.0));
  d.line("stiffness = {}", SceneDraft::numbers(springs));
  if (grounded) d.line("ground_stiffness = {}", SceneDraft::numbers(d.values(masses, 0.0, 1.0)));
  d.key("damping", d.chance(0.2) ? 0.0 : d.chance(0.85) ? d.uniform(0.0, 0.05) : d.uniform(0.5, 4.0));
  if (d.chance(0.2)) d.key("mass_damping", d.uniform(0.0, 0.2));
}

void link(SceneDraft& d, int mass, int other, double stiffness) {
  d.line("\n[[structure.link]]");
  if (other == 0)
    d.line("at = {}", mass);
  else
    d.line("between = [{}, {}]", other, mass);
  d.key("stiffness", stiffness);
  d.key("damping", d.chance(0.2) ? 0.0 : d.chance(0.9) ? d.uniform(0.0, 0.15) : d.uniform(1.0, 8.0));
}

void linked_masses(SceneDraft& d, int masses) {
  d.dofs = masses;
  d.floats = true;  // perhaps
  d.line("kind = \"masses\"\nmass = {}", SceneDraft::numbers(d.masses_of(masses)));
  for (int i = 1; i <= masses; ++i) {
    if (i > 1 || d.chance(0.85)) {
      const int other = i == 1 ? 0 : d.integer(d.chance(0.2) ? 0 : 1, i - 1);
      link(d, i, other, d.chance(0.12) ? 0.0 : d.spring(0.3, 3.0));
    }
    if (d.chance(0.15)) link(d, i, 0, d.uniform(0.0, 1.0));
  }
}

using Rows = std::vector<std::vector<double>>;

/// diagonal·I + Σ_k size_k·a_k a_kᵀ over `rank` random vectors, as rows.
template <class Size>
Rows positive(SceneDraft& d, int n, int rank, double diagonal, Size size) {
  const auto count = static_cast<std::size_t>(n);
  Rows A(count, std::vector<double>(count, 0.0));
  for (int k = 0; k < rank; ++k) {
    const std::vector<double> a = d.values(n, -1.0, 1.0);
    const double own = size();
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j) A[i][j] += own * (a[i] * a[j]);
  }
  for (std::size_t i = 0; i < count; ++i) A[i][i] += diagonal;
  return A;
}

std::string text_of(const Rows& A) {
  std::string text = "[";
  for (const auto& row : A) text += (text.size() > 1 ? ", " : "") + SceneDraft::numbers(row);
  return text + "]";
}

void add_skew(SceneDraft& d, Rows& A, double size) {
  for (std::size_t i = 0; i < A.size(); ++i)
    for (std::size_t j = i + 1; j < A.size(); ++j) {
      const double s = d.uniform(-size, size);
      A[i][j] += s;
      A[j][i] -= s;
    }
}

void matrices(SceneDraft& d, int n) {
  d.dofs = n;
  d.line("kind = \"matrices\"");
  d.line("mass = {}", text_of(positive(d, n, n, 0.3, [] { return 0.5; })));
  Rows damping = positive(d, n, n, 0.01, [] { return 0.1; });
  if (d.chance(0.2)) add_skew(d, damping, 0.05);
  d.line("damping = {}", text_of(damping));
  d.floats = d.chance(0.2);
  const double diagonal = d.floats || d.chance(0.2) ? 0.0 : 0.2;
  d.line("stiffness = {}",
         text_of(positive(d, n, d.floats ? n - 1 : n, diagonal, [&d] { return d.spring(1.0, 1.0); })));
}

void beam_damping(SceneDraft& d) {
  const int kind = d.integer(0, 6);
  if (kind == 0) return;
  d.line("\n[structure.damping]");
  const double hertz = d.rate / (2.0 * std::numbers::pi);
  if (kind == 1) {
    d.line("modal_ratio = {}", SceneDraft::numbers(d.values(d.integer(1, d.dofs), 1e-3, 0.05)));
  } else if (kind == 2) {
    d.key("coefficient", d.uniform(0.0, 0.05) / d.rate);
    if (d.chance(0.5)) d.key("mass_coefficient", d.uniform(0.0, 0.1) * d.rate);
  } else if (kind == 3) {
    d.key("ratio", d.uniform(1e-3, 0.05));
    d.key("frequency", hertz * d.uniform(0.5, 5.0));
  } else if (kind == 4) {
    d.line("ratio = {}", SceneDraft::numbers(d.values(2, 0.02, 0.03)));
    d.fill("frequency = [#, #]", {hertz * d.uniform(0.5, 1.0), hertz * d.uniform(4.0, 8.0)});
  } else {
    d.key("modal_ratio", d.uniform(1e-3, 0.05));
  }
}

void beam(SceneDraft& d) {
  d.line("kind = \"beam\"");
  const bool timoshenko = d.chance(0.3);
  d.line("theory = \"{}\"", timoshenko ? "timoshenko" : "euler-bernoulli");
  const int spans = d.chance(0.2) ? 2 : 1;
  double length = 0.0, give = 0.0, mass = 0.01;
  for (int s = 0; s < spans; ++s) {
    const double own = d.uniform(0.2, 0.6) / spans, width = d.uniform(0.01, 0.03), thickness = d.uniform(5e-4, 2e-3),
                 modulus = d.chance(0.5) ? 2e11 : d.uniform(0.5e11, 2.1e11), density = d.uniform(2500.0, 8000.0);
    const int elements = d.chance(0.1) ? d.integer(4, 8) : d.integer(1, 4 - spans);
    if (spans > 1) d.line("\n[[structure.span]]");
    d.fill("length = #\nwidth = #\nthickness = #\nyoungs_modulus = #\ndensity = #",
           {own, width, thickness, modulus, density});
    d.line("elements = {}", elements);
    if (timoshenko && d.chance(0.5))
      d.fill("poisson_ratio = #\nshear_coefficient = #", {d.uniform(0.1, 0.45), d.uniform(0.6, 0.9)});
    for (int e = 1; e <= elements; ++e) d.nodes.push_back(length + own * e / elements);
    length += own;
    give += own * own * own / (3.0 * modulus * width * thickness * thickness * thickness / 12.0);
    mass += density * width * thickness * own * 0.25;
  }
  d.dofs = 2 * static_cast<int>(d.nodes.size());
  d.stiffness = 1.0 / (give * spans * spans);
  d.rate = std::sqrt(d.stiffness / mass);
  d.size = d.uniform(1e-3, 1e-2);
  if (d.chance(0.5)) {
    d.line("\n[structure.tip]");
    d.key("mass", d.uniform(0.0, 0.02));
    d.key("inertia", d.uniform(0.0, 1e-5));
    d.key("offset", d.uniform(0.0, 0.01));
    if (d.chance(0.5)) d.key("extension", d.uniform(0.0, 0.05));
  }
  beam_damping(d);
}

}  // namespace

void write_structure(SceneDraft& d) {
  const double kind = d.uniform(0.0, 1.0), large = d.uniform(0.0, 1.0);
  d.beam = kind > 0.86;
  d.line("units = \"{}\"\n\n[structure]", d.beam ? "SI" : "dimensionless");
  const int masses = large < 0.003 ? d.integer(61, 200) : large < 0.04 ? d.integer(13, 60) : d.integer(1, 12);
  d.mixed = !d.beam && d.chance(0.12);
  if (kind < 0.43) return chain(d, masses);
  if (kind < 0.69) return linked_masses(d, masses);
  if (!d.beam) return matrices(d, std::min(masses, d.chance(0.1) ? 12 : 4));
  beam(d);
}

}  // namespace slipmode::selftest
