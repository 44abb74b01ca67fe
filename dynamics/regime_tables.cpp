#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/dynamics/regime.hpp>
#include "dynamics/internal/lobatto.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace slipmode::dynamics {
namespace {

/// The longest window, in radians of the fastest pair: 2^32. Overdamped pairs of a fine mesh decay that much faster
/// than anything moves.
constexpr double kTopPhase = 4294967296.0;
/// Below this phase a short Taylor series is exact to rounding.
constexpr double kTabulatedPhase = 0.25;
/// Quadrature over this many radians at once.
constexpr double kQuadraturePhase = 4.0;
/// Powers of t in a regime's inputs: constant, linear, quadratic.
constexpr int kForcingPowers = 3;
/// Inputs (and one) whose coefficients need no heap.
constexpr Eigen::Index kFewInputs = 8;
/// Exponent beyond which a growing window is useless anyway.
constexpr double kLargestExponent = 200.0;

/// 1/k: a division takes several times as long as a product.
constexpr auto kInverse = [] {
  std::array<double, kernels::kMostTerms + 1> out{};
  for (std::size_t k = 1; k < out.size(); ++k) out[k] = 1.0 / static_cast<double>(k);
  return out;
}();

/// M_k = ∫₀ᵗ e^{G(t−s)} s^k/k! ds for k = 0, 1, 2.
struct Moments {
  Eigen::Matrix2d of0 = Eigen::Matrix2d::Zero(), of1 = Eigen::Matrix2d::Zero(), of2 = Eigen::Matrix2d::Zero();
};

/// ∫₀ᵗ e^{μ(t−s)} s^k/k! ds for k = 0, 1, 2: t^{k+1} φ_{k+1}(μt).
std::array<double, 3> scalar_moments(double mu, double t) {
  const double z = mu * t;
  if (std::abs(z) > 1.0) {
    const double first = std::expm1(z) / mu, second = (first - t) / mu;
    return {first, second, (second - t * t / 2.0) / mu};
  }
  std::array<double, 3> out{};
  double power = t;  // t^{k+1}
  for (int k = 0; k < 3; ++k, power *= t) {
    double term = 1.0;
    for (int j = 2; j <= k + 1; ++j) term /= j;
    for (int j = k + 2; std::abs(term) > 1e-18; term *= z / j++) out[static_cast<std::size_t>(k)] += power * term;
  }
  return out;
}

/// Two real eigenvalues far apart, also within the time: each has its own integral, however fast the faster one is.
/// Within less than a radian these would be all but equal, and the difference of two integrals is what is wanted.
std::optional<Moments> separate_moments(const Eigen::Matrix2d& G, double t) {
  const double half = G.trace() / 2.0, determinant = G.determinant(), gap = half * half - determinant;
  if (!(gap > 0.25 * half * half)) return std::nullopt;
  const double root = std::sqrt(gap), fast = half < 0 ? half - root : half + root, slow = determinant / fast;
  if (std::abs(fast - slow) * t < 1.0) return std::nullopt;
  const Eigen::Matrix2d of_fast = (G - slow * Eigen::Matrix2d::Identity()) / (fast - slow);
  const Eigen::Matrix2d of_slow = (G - fast * Eigen::Matrix2d::Identity()) / (slow - fast);
  const std::array<double, 3> a = scalar_moments(fast, t), b = scalar_moments(slow, t);
  return Moments{a[0] * of_fast + b[0] * of_slow, a[1] * of_fast + b[1] * of_slow, a[2] * of_fast + b[2] * of_slow};
}

Moments moments(const ModalModel& pairs, Eigen::Index i, double rate, const Eigen::Matrix2d& E, double t) {
  Moments out;
  Eigen::Matrix2d G;
  G << pairs.g11(i), pairs.g12(i), pairs.g21(i), pairs.g22(i);
  const double phase = rate * t, slowest = std::abs(G.determinant()) / std::max(rate, 1e-300) * t;
  if (slowest > 1.0) {  // then nothing cancels in the antiderivatives
    const Eigen::Matrix2d inverse = G.inverse(), I = Eigen::Matrix2d::Identity();
    out.of0 = inverse * (E - I);
    out.of1 = inverse * (out.of0 - t * I);
    out.of2 = inverse * (out.of1 - t * t / 2.0 * I);
    return out;
  }
  if (const auto separate = separate_moments(G, t)) return *separate;
  static const GaussRule rule = gauss_rule(16);
  const int panels = 1 + static_cast<int>(phase / kQuadraturePhase);
  for (int p = 0; p < panels; ++p)
    for (Eigen::Index k = 0; k < rule.node.size(); ++k) {
      const double s = t * (p + rule.node(k)) / panels, weight = t * rule.weight(k) / panels;
      const Eigen::Matrix2d S = weight * pairs.exponential(i, t - s);
      out.of0 += S;
      out.of1 += s * S;
      out.of2 += s * s / 2.0 * S;
    }
  return out;
}

}  // namespace

RegimeTables::RegimeTables(const HybridSystem& system, const ModalModel& slipping,
                           const std::vector<ContactRole>& roles)
    : regime_(system, slipping, roles) {
  const double first = first_step(kTopPhase / regime_.rate);
  for (int level = 0; level < kLevels; ++level) length_[static_cast<std::size_t>(level)] = std::ldexp(first, -level);
}

int RegimeTables::level_covering(double wanted) const {
  return std::clamp(std::ilogb(length_[0] / wanted), 0, kLevels - 1);
}

void RegimeTables::step_of(double h, RegimeStep& out) const {
  const ModalModel& pairs = regime_.pairs;
  const auto np = pairs.np, V = regime_.speed_input();
  out.h = h;
  for (auto* e : {&out.e11, &out.e12, &out.e21, &out.e22}) *e = Eigen::VectorXd::Zero(np);
  out.response = Eigen::MatrixXd::Zero(2 * np, regime_.inputs());
  for (Eigen::Index i = 0; i < pairs.n; ++i) {
    const Eigen::Matrix2d E = pairs.exponential(i, h);
    out.e11(i) = E(0, 0);
    out.e12(i) = E(0, 1);
    out.e21(i) = E(1, 0);
    out.e22(i) = E(1, 1);
    const Moments M = moments(pairs, i, regime_.pair_rate(i), E, h);
    const auto pair_of = [&](const auto& column) { return Eigen::Vector2d(column(i), column(np + i)); };
    const Eigen::Vector2d held = pair_of(regime_.B_follows), speed = pair_of(regime_.B.col(V));
    for (Eigen::Index k = 0; k < regime_.inputs(); ++k) {
      Eigen::Vector2d r = M.of0 * pair_of(regime_.B.col(k));
      if (k == V) r += M.of1 * held;
      if (k == V + 1) r += M.of1 * speed + M.of2 * held;
      out.response(i, k) = r(0);
      out.response(np + i, k) = r(1);
    }
  }
}

void RegimeTables::make(RegimeStep& out, int level) const { step_of(length(level), out); }

void RegimeTables::make(RegimeChange& out, int level) const {
  const auto np = regime_.pairs.np;
  const Eigen::VectorXd change = regime_.motion.changes(Eigen::VectorXd::Constant(1, length(level)));
  out = {change.head(np), change.segment(np, np), change.segment(2 * np, np), change.tail(np)};
}

void RegimeTables::make(RegimeAudit& out, int level) const {
  const double h = length(level);
  out.rule = gauss_rule(8 + static_cast<int>(std::ceil(0.75 * regime_.rate * h)));
  out.point.resize(static_cast<std::size_t>(out.rule.node.size()));
  for (std::size_t j = 0; j < out.point.size(); ++j)
    step_of(out.rule.node(static_cast<Eigen::Index>(j)) * h, out.point[j]);
}

void RegimeTables::make(RegimeWindow& out, int level) const {
  const Regime& r = regime_;
  const auto np = r.pairs.np, ni = r.inputs(), no = r.row.cols(), V = r.speed_input();
  const double h = length(level);
  out.from_state = Eigen::MatrixXd::Zero(8, 2 * np * no);
  out.from_inputs = Eigen::MatrixXd::Zero(8, ni * no);
  // A pair too fast to be interpolated is left out: of its free motion all that matters is how large it can be.
  const auto share = [&](Eigen::Index i) { return interpolation_share(r.pair_rate(i), h); };
  const auto interpolated = [&](Eigen::Index i) { return share(i) < 1.0 || r.scale1(i) == 0.0 || r.scale2(i) == 0.0; };
  RegimeStep step;
  for (int j = 0; j < 8; ++j) {
    const double t = lobatto().point(j) * h;
    step_of(t, step);
    for (Eigen::Index i = 0; i < r.pairs.n; ++i) {
      if (interpolated(i)) continue;
      step.e11(i) = step.e12(i) = step.e21(i) = step.e22(i) = 0.0;
      for (const Eigen::Index k : {i, np + i}) {
        Eigen::RowVectorXd follows = r.particular.row(k);
        double held = 0.0;
        for (std::size_t d = 0; d < r.follows.size(); ++d)
          if (r.follows[d]) held += r.particular(k, static_cast<Eigen::Index>(d));
        follows(V) += held * t;
        follows(V + 1) += held * t * t / 2.0 + r.particular(k, V) * t;
        step.response.row(k) = follows;
      }
    }
    for (Eigen::Index c = 0; c < no; ++c) {
      const auto first = r.row.col(c).head(np), second = r.row.col(c).tail(np);
      out.from_state.row(j).segment(2 * np * c, np) =
          (first.cwiseProduct(step.e11) + second.cwiseProduct(step.e21)).transpose();
      out.from_state.row(j).segment(2 * np * c + np, np) =
          (first.cwiseProduct(step.e12) + second.cwiseProduct(step.e22)).transpose();
      Eigen::RowVectorXd inputs = r.row.col(c).transpose() * step.response + r.coefficient.col(c).transpose();
      double followed = 0.0;
      for (std::size_t d = 0; d < r.follows.size(); ++d)
        if (r.follows[d]) followed += r.coefficient(static_cast<Eigen::Index>(d), c);
      inputs(V) += followed * t;
      inputs(V + 1) += followed * t * t / 2.0 + r.coefficient(V, c) * t;
      out.from_inputs.row(j).segment(ni * c, ni) = inputs;
    }
  }
  out.from_state = (lobatto().bernstein * out.from_state).eval();
  out.from_inputs = (lobatto().bernstein * out.from_inputs).eval();

  out.remainder = Eigen::MatrixXd::Zero(np, no);
  for (Eigen::Index i = 0; i < r.pairs.n; ++i)
    out.remainder.row(i) = (interpolated(i) ? std::min(kInterpolationGain, share(i)) : 1.0) *
                           std::exp(std::min(r.growth * h, kLargestExponent)) * r.weight.row(i);
}

void apply(const RegimeStep& s, const double* x, const Eigen::VectorXd& inputs, double* out_x) {
  kernels::kernels().propagate({s.e11.size(), static_cast<int>(inputs.size()), s.e11.data(), s.e12.data(), s.e21.data(),
                                s.e22.data(), nullptr, s.response.data()},
                               x, inputs.data(), out_x);
}

void advance(const RegimeTables& tables, double t, Eigen::VectorXd& x, Eigen::VectorXd& inputs) {
  const Regime& r = tables.regime();
  const ModalModel& m = r.pairs;
  const auto ni = r.inputs(), V = r.speed_input();
  const bool tabulated = r.rate * t > kTabulatedPhase;
  for (int level = tabulated ? tables.level_covering(t) : 0;
       level < RegimeTables::kLevels && r.rate * t > kTabulatedPhase;) {
    const double h = tables.length(level);
    if (h > t) {
      ++level;
      continue;
    }
    apply(tables.step(level), x.data(), inputs, x.data());
    r.advance_inputs(inputs, h);
    t -= h;
  }
  if (t == 0.0) return;
  // f = B ι, ḟ = B_follows V + B_V a, f̈ = B_follows a.
  const double speed = inputs(V), acceleration = inputs(V + 1);
  const double phase = r.rate * t;
  // The first term of a motion that begins on a belt is at most the fourth, of a place that its acceleration moves.
  int terms = 4;
  for (double left = 1.0; left > 1e-17 && terms < kernels::kMostTerms;)
    left *= phase * kInverse[static_cast<std::size_t>(++terms)];
  alignas(64) double few[kNodes * kFewInputs];
  Eigen::VectorXd many;
  double* coefficient = few;
  if (ni + 1 > kFewInputs) {
    many.resize(kNodes * (ni + 1));
    coefficient = many.data();
  }
  for (Eigen::Index d = 0; d <= ni; ++d) {
    double* of = coefficient + kNodes * d;
    of[0] = d < ni ? inputs(d) * t : 0.0;
    of[1] = (d == V ? acceleration : d == ni ? speed : 0.0) * t * t;
    of[2] = (d == ni ? acceleration / 2.0 : 0.0) * t * t * t;
  }
  kernels::kernels().taylor({m.np, static_cast<int>(ni + 1), m.g11.data(), m.g12.data(), m.g21.data(), m.g22.data(),
                             nullptr, r.forcing.data(), kForcingPowers},
                            x.data(), coefficient, t, terms, x.data());
  r.advance_inputs(inputs, t);
}

}  // namespace slipmode::dynamics
