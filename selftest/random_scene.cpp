#include "selftest/random_scene.hpp"

#include <slipmode/core/random.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string_view>
#include <vector>

namespace slipmode::selftest {
namespace {

/// A number as TOML writes a float.
std::string number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string numbers(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + number(value);
  return text + "]";
}

/// Writes one scene. The scales make friction matter: forces of the order of a spring times a displacement.
class SceneWriter {
 public:
  SceneWriter(std::uint64_t seed, std::uint64_t index) : random_(Random::stream(seed, index)) {
    text_ = fmt::format("title = \"Random scene {} of seed {}\"\n", index, seed);
  }

  std::string write() {
    structure();
    linear_ = chance(0.55);  // of piecewise-linear laws alone
    const int count = std::min(dofs_ / (beam_ ? 2 : 1), integer(1, 3));
    choose_places(count);
    for (int c = 0; c < count; ++c) contact(c);
    drive();
    time();
    start();
    return text_;
  }

 private:
  double uniform(double low, double high) { return random_.uniform(low, high); }
  double scatter(double low, double high) { return low * std::exp(uniform(0.0, std::log(high / low))); }
  bool chance(double p) { return random_.uniform() < p; }
  int integer(int low, int high) { return low + static_cast<int>(random_.uniform() * (high - low + 1)); }
  std::vector<double> values(int count, double low, double high) {
    std::vector<double> result(static_cast<std::size_t>(count));
    for (double& value : result) value = uniform(low, high);
    return result;
  }
  template <class... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    text_ += fmt::format(format, std::forward<Args>(args)...) + "\n";
  }
  void key(const char* name, double value) { line("{} = {}", name, number(value)); }
  /// A line with a number in place of each '#'. A braced list is evaluated from left to right, arguments are not.
  void fill(std::string_view format, std::initializer_list<double> values_in) {
    const double* value = values_in.begin();
    for (const char c : format) text_ += c == '#' ? number(*value++) : std::string(1, c);
    text_ += '\n';
  }

  void structure() {
    const double kind = uniform(0.0, 1.0);
    beam_ = kind > 0.88;
    line("units = \"{}\"\n\n[structure]", beam_ ? "SI" : "dimensionless");
    const int masses = chance(0.04) ? integer(13, 60) : integer(1, 12);
    if (kind < 0.45) {
      chain(masses);
    } else if (kind < 0.72) {
      linked_masses(std::min(masses, 12));
    } else if (!beam_) {
      matrices(std::min(masses, 4));
    } else {
      beam();
    }
  }

  void chain(int masses) {
    dofs_ = masses;
    const bool left = masses == 1 || chance(0.8), right = chance(0.2);
    line("kind = \"chain\"\nmasses = {}\nends = \"{}\"", masses,
         left && right ? "fixed-fixed"
         : left        ? "fixed-free"
         : right       ? "free-fixed"
                       : "free-free");
    line("mass = {}", numbers(values(masses, 0.3, 2.5)));
    const int springs = masses - 1 + (left ? 1 : 0) + (right ? 1 : 0);
    line("stiffness = {}", numbers(values(springs, 0.3, 3.0)));
    if (chance(0.3)) line("ground_stiffness = {}", numbers(values(masses, 0.0, 1.0)));
    key("damping", chance(0.2) ? 0.0 : chance(0.85) ? uniform(0.0, 0.05) : uniform(0.5, 4.0));
    if (chance(0.2)) key("mass_damping", uniform(0.0, 0.2));
  }

  void linked_masses(int masses) {
    dofs_ = masses;
    line("kind = \"masses\"\nmass = {}", numbers(values(masses, 0.3, 2.5)));
    for (int i = 1; i <= masses; ++i) {
      if (i > 1 || chance(0.85)) {
        const int other = i == 1 ? 0 : integer(chance(0.2) ? 0 : 1, i - 1);
        link(i, other, chance(0.12) ? 0.0 : uniform(0.3, 3.0));
      }
      if (chance(0.15)) link(i, 0, uniform(0.0, 1.0));
    }
  }

  void link(int mass, int other, double stiffness) {
    line("\n[[structure.link]]");
    if (other == 0)
      line("at = {}", mass);
    else
      line("between = [{}, {}]", other, mass);
    key("stiffness", stiffness);
    key("damping", chance(0.2) ? 0.0 : chance(0.9) ? uniform(0.0, 0.15) : uniform(1.0, 8.0));
  }

  void matrices(int n) {
    dofs_ = n;
    line("kind = \"matrices\"");
    line("mass = {}", rows(positive(n, n, 0.3, 0.5), 0.0));
    const double skew = chance(0.2) ? 0.05 : 0.0;
    line("damping = {}", rows(positive(n, n, 0.01, 0.1), skew));
    const int rank = chance(0.2) ? n - 1 : n;
    const double diagonal = chance(0.2) ? 0.0 : 0.2;
    line("stiffness = {}", rows(positive(n, rank, diagonal, 1.0), 0.0));
  }

  /// diagonal·I + Σ_k size·a_k a_kᵀ over `rank` random vectors, as rows.
  std::vector<std::vector<double>> positive(int n, int rank, double diagonal, double size) {
    const auto count = static_cast<std::size_t>(n);
    std::vector<std::vector<double>> A(count, std::vector<double>(count, 0.0));
    for (int k = 0; k < rank; ++k) {
      const std::vector<double> a = values(n, -1.0, 1.0);
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < count; ++j) A[i][j] += size * (a[i] * a[j]);
    }
    for (std::size_t i = 0; i < count; ++i) A[i][i] += diagonal;
    return A;
  }

  std::string rows(std::vector<std::vector<double>> A, double skew) {
    std::string text = "[";
    for (std::size_t i = 0; i < A.size(); ++i) {
      for (std::size_t j = i + 1; j < A.size() && skew > 0.0; ++j) {
        const double s = uniform(-skew, skew);
        A[i][j] += s;
        A[j][i] -= s;
      }
      text += (i > 0 ? ", " : "") + numbers(A[i]);
    }
    return text + "]";
  }

  void beam() {
    const int elements = integer(1, 3);
    dofs_ = 2 * elements;
    length_ = uniform(0.2, 0.6);
    const double width = uniform(0.01, 0.03), thickness = uniform(5e-4, 2e-3), modulus = 2e11;
    stiffness_ = 3.0 * modulus * width * thickness * thickness * thickness / 12.0 / (length_ * length_ * length_);
    const bool timoshenko = chance(0.3);
    line("kind = \"beam\"\ntheory = \"{}\"", timoshenko ? "timoshenko" : "euler-bernoulli");
    key("length", length_);
    key("width", width);
    key("thickness", thickness);
    key("youngs_modulus", modulus);
    key("density", 7800.0);
    line("elements = {}", elements);
    if (chance(0.5)) {
      line("\n[structure.tip]");
      key("mass", uniform(0.0, 0.02));
      key("inertia", uniform(0.0, 1e-5));
      key("offset", uniform(0.0, 0.01));
      if (chance(0.5)) key("extension", uniform(0.0, 0.05));
    }
    if (chance(0.8)) line("\n[structure.damping]\nmodal_ratio = {}", number(uniform(1e-3, 0.05)));
    const double mass = 7800.0 * width * thickness * length_ * 0.25 + 0.01;
    rate_ = std::sqrt(stiffness_ / mass);
    size_ = uniform(1e-3, 1e-2);
  }

  /// A degree of freedom of its own for every contact, so that none depends on the others.
  void choose_places(int count) {
    const int most = beam_ ? dofs_ / 2 : dofs_;
    while (static_cast<int>(places_.size()) < count) {
      const int place = integer(1, most);
      if (std::ranges::find(places_, place) == places_.end()) places_.push_back(place);
    }
  }

  void place(int c) {
    const int own = places_[static_cast<std::size_t>(c)], most = beam_ ? dofs_ / 2 : dofs_;
    if (beam_) {
      if (own == most)
        line("at = \"tip\"");
      else
        key("at", length_ * own / most);
      return;
    }
    const int other = integer(1, most);
    if (chance(0.2) && std::ranges::find(places_, other) == places_.end())
      line("between = [{}, {}]", other, own);
    else
      line("at = {}", own);
  }

  void contact(int c) {
    line("\n[[contact]]");
    place(c);
    if (linear_ && chance(0.35)) return clearance();
    const double mu_k = chance(0.08) ? 0.0 : uniform(0.05, 0.5);
    const double mu_s = chance(0.2) ? mu_k : mu_k + (chance(0.1) ? uniform(1.0, 5.0) : uniform(0.0, 0.5));
    const int kind = linear_ ? integer(0, 1) : integer(0, 4);
    if (kind == 0 || (linear_ && kind == 1)) {
      if (kind == 1)
        line("law = \"compliant\"\nstiffness = {}", number(stiffness_ * scatter(1.0, 200.0)));
      else
        line("law = \"coulomb\"");
      key("mu_s", mu_s);
      key("mu_k", mu_k);
      if (linear_ && mu_k > 0.1 && chance(0.2)) key("tilt_deg", uniform(-5.0, 5.0));
      return load(linear_);
    }
    if (kind == 1) {
      line("law = \"stribeck\"\nalpha = {}", number(uniform(0.2, 15.0) / speed()));
    } else if (kind == 2) {
      fill("law = \"tanh\"\nalpha = #\nepsilon = #", {uniform(0.2, 15.0) / speed(), uniform(0.02, 0.2) * speed()});
    } else if (kind == 3) {
      fill("law = \"dahl\"\nmu = #\nstiffness = #", {uniform(0.1, 0.6), stiffness_ * scatter(1.0, 200.0)});
      return load(false);
    } else {
      const double bristle = stiffness_ * scatter(1.0, 200.0);
      fill("law = \"lugre\"\nstribeck_speed = #\nstiffness = #", {uniform(0.02, 0.5) * speed(), bristle});
      key("damping", chance(0.3) ? 0.0 : uniform(0.0, 0.5) * std::sqrt(bristle * stiffness_) / rate_);
      key("viscous", chance(0.5) ? 0.0 : uniform(0.0, 0.3) * stiffness_ / rate_);
      key("mu_s", std::max(mu_s, 0.1));
      key("mu_k", std::clamp(mu_k, 0.1, std::max(mu_s, 0.1)));
      return load(false);
    }
    key("mu_s", mu_s);
    key("mu_k", mu_k);
    load(false);
  }

  void clearance() {
    const double damping = chance(0.3) ? 0.0 : uniform(0.05, 1.0) * stiffness_ / rate_;
    line("law = \"clearance\"\nloss = \"{}\"", chance(0.5) ? "gap" : "zero-force");
    const auto stop = [&](const std::string& name) {
      const bool closed = chance(0.1);
      closed_ = closed_ || closed;
      fill(name + " = { stiffness = #, damping = #, gap = # }",
           {stiffness_ * scatter(1.0, 100.0), damping, closed ? 0.0 : size_ * uniform(0.05, 0.8)});
    };
    const int sides = integer(0, 3);
    if (sides != 1) stop("left");
    if (sides != 2) stop("right");
  }

  void load(bool varying) {
    const double constant = stiffness_ * size_ * uniform(0.2, 3.0);
    const double kind = varying ? uniform(0.0, 1.0) : 0.0;
    if (kind < 0.6) return key("normal_load", constant);
    if (kind < 0.85) {
      line("normal_load = {{ constant = {}, slope = {} }}", number(constant), number(stiffness_ * uniform(-1.5, 1.5)));
      return;
    }
    fill(
        "normal_load = { constant = #, oscillator = { mass = #, support_stiffness = #, support_damping = #, "
        "spring_stiffness = #, spring_damping = #, slope = # } }",
        {constant, stiffness_ / (rate_ * rate_) * uniform(0.2, 2.0), stiffness_ * uniform(0.0, 3.0),
         stiffness_ / rate_ * uniform(0.0, 0.2), stiffness_ * uniform(0.5, 3.0),
         chance(0.5) ? 0.0 : stiffness_ / rate_ * uniform(0.0, 0.2), uniform(-0.5, 0.5)});
  }

  void drive() {
    line("\n[drive]");
    const double kind = uniform(0.0, 1.0);
    if (kind < (linear_ ? 0.4 : 0.7)) {
      line("kind = \"belt\"");
      belt_ = chance(0.15) ? 0.0 : uniform(-1.0, 1.0) * speed();
      const double begin = uniform(0.0, 5.0) / rate_;
      if (chance(0.75))
        key("speed", belt_);
      else
        fill("speed = { from = #, to = #, begin = #, end = # }",
             {belt_, uniform(-1.0, 1.0) * speed(), begin, begin + uniform(0.5, 10.0) / rate_});
    } else if (!linear_ || kind < 0.7) {
      const double omega = rate_ * uniform(0.3, 2.5), amplitude = size_ * uniform(0.2, 3.0), phase = uniform(0.0, 6.0);
      belt_ = amplitude * omega * std::cos(phase);
      line("kind = \"shaker\"");
      key("frequency", omega / (2.0 * std::numbers::pi));
      key("amplitude", amplitude);
      key("phase", phase);
    } else {
      force();
    }
  }

  void force() {
    line("kind = \"force\"");
    key("omega", rate_ * uniform(0.3, 2.5));
    const double size = stiffness_ * size_;
    const auto harmonic = [&] {
      key("amplitude", size * uniform(0.1, 2.0));
      key("phase", uniform(0.0, 6.0));
    };
    harmonic();
    if (beam_)
      line("at = \"tip\"");
    else
      line("at = {}", integer(1, dofs_));
    if (chance(0.4)) key("mean", size * uniform(-0.3, 0.3));
    for (int order = 2; order <= 3; ++order) {
      if (!chance(0.3)) continue;
      line("\n[[drive.harmonic]]\norder = {}", order);
      harmonic();
    }
  }

  void time() {
    line("\n[time]");
    const double duration = uniform(8.0, 30.0) / rate_;
    key("duration", duration);
    key("sample", duration / 200.0);
  }

  void start() {
    const double kind = uniform(0.0, 1.0);
    if (kind < 0.15 && !closed_) return;  // at rest just on a stop rounding decides
    const double size = size_ * uniform(0.0, 2.0);
    std::vector<double> q, v;
    const double bend = uniform(-size, size), swing = uniform(-size, size) * rate_;
    for (int i = 0; i < dofs_; ++i) {
      if (beam_) {  // y = bend (x/L)² and its slope
        const double x = static_cast<double>(i / 2 + 1) / (dofs_ / 2);
        const double share = i % 2 == 0 ? x * x : 2.0 * x / length_;
        q.push_back(bend * share);
        v.push_back(swing * share);
      } else {
        q.push_back(uniform(-size, size));
        v.push_back(uniform(-size, size));
      }
    }
    if (kind < 0.3 && !beam_) v.assign(v.size(), belt_);  // contacts with the ground at rest on their counterpart
    line("\n[initial]\ndisplacement = {}\nvelocity = {}", numbers(q), numbers(v));
  }

  [[nodiscard]] double speed() const { return size_ * rate_; }

  Random random_;
  std::string text_;
  int dofs_ = 1;
  bool beam_ = false, linear_ = false, closed_ = false;
  std::vector<int> places_;
  double length_ = 1.0;
  /// Typical spring, rate and displacement; and the counterpart's speed at the start.
  double stiffness_ = 1.0, rate_ = 1.0, size_ = 1.0, belt_ = 0.0;
};

}  // namespace

std::string random_scene_text(std::uint64_t seed, std::uint64_t index) { return SceneWriter(seed, index).write(); }

}  // namespace slipmode::selftest
