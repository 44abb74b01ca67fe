#include <slipmode/orbits/gap_motion.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/floquet.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace slipmode::orbits {

namespace {

using Complex = std::complex<double>;

/// X of a harmonic's steady response Im(X e^{imωt}).
Eigen::VectorXcd harmonic_response(const dynamics::HybridSystem& system, const friction::ForceHarmonic& harmonic,
                                   double base) {
  const double omega = harmonic.order * base;
  const Complex i(0.0, 1.0);
  const Eigen::MatrixXcd stiffness = fem::to_dense(system.structure().K()).cast<Complex>() +
                                     i * omega * fem::to_dense(system.structure().C()) -
                                     omega * omega * fem::to_dense(system.structure().M());
  const Eigen::VectorXcd force =
      system.force_directions().col(harmonic.direction) * (harmonic.amplitude * std::exp(i * harmonic.phase));
  const Eigen::FullPivLU<Eigen::MatrixXcd> factor(stiffness);
  if (!factor.isInvertible()) {
    throw InvalidInput(
        fmt::format("linear response: expected a frequency at which the structure does not resonate, "
                    "found {} rad/s. Give it damping, or another start",
                    omega));
  }
  return factor.solve(force);
}

/// Displacement under the constant load, of minimum norm.
Eigen::VectorXd mean_response(const dynamics::HybridSystem& system) {
  if (system.load().size() == 0) return Eigen::VectorXd::Zero(system.size());
  return Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(fem::to_dense(system.structure().K()))
      .solve(system.load());
}

/// Upper bounds of Σ Im(Y_m e^{imωt}) and of its negative: samples, and what the curve can rise between two of them.
Eigen::Vector2d reach_of(const std::vector<Complex>& coefficients, const friction::Force& force) {
  constexpr int kSamples = 4096;
  double high = 0.0, low = 0.0, curvature = 0.0;
  const double step = 2.0 * std::numbers::pi / kSamples;
  for (std::size_t m = 0; m < coefficients.size(); ++m) {
    curvature += std::abs(coefficients[m]) * std::pow(force.harmonics[m].order, 2);
  }
  for (int k = 0; k < kSamples; ++k) {
    double value = 0.0;
    for (std::size_t m = 0; m < coefficients.size(); ++m) {
      value += (coefficients[m] * std::polar(1.0, force.harmonics[m].order * k * step)).imag();
    }
    high = std::max(high, value);
    low = std::min(low, value);
  }
  // Within half a step of an extreme: curvature · (h/2)²/2. One harmonic is known exactly.
  if (coefficients.size() == 1) return Eigen::Vector2d::Constant(std::abs(coefficients.front()));
  return Eigen::Vector2d(high, -low).array() + curvature * step * step / 8.0;
}

Eigen::MatrixXd state_matrix(const fem::Structure& structure) {
  const Eigen::Index n = structure.size();
  const Eigen::LLT<Eigen::MatrixXd> mass(fem::to_dense(structure.M()));
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  G.topRightCorner(n, n).setIdentity();
  G.bottomLeftCorner(n, n) = -mass.solve(fem::to_dense(structure.K()));
  G.bottomRightCorner(n, n) = -mass.solve(fem::to_dense(structure.C()));
  return G;
}

/// Steady motion under a force, by its parts.
struct Response {
  Eigen::VectorXd mean;
  std::vector<Eigen::VectorXcd> harmonics;  ///< as the force's

  explicit Response(const dynamics::HybridSystem& system) : mean(mean_response(system)) {
    const friction::Force* force = system.drive().force();
    if (force == nullptr) {
      throw InvalidInput("linear response: expected a force drive, found a belt or a shaker. Give the start itself");
    }
    harmonics.reserve(force->harmonics.size());
    for (const auto& harmonic : force->harmonics) {
      harmonics.push_back(harmonic_response(system, harmonic, force->omega));
    }
  }

  [[nodiscard]] dynamics::State at_start(const dynamics::HybridSystem& system) const {
    const friction::Force& force = *system.drive().force();
    dynamics::State state = system.rest();
    state.modes = {};
    state.q = mean;
    for (std::size_t m = 0; m < harmonics.size(); ++m) {
      state.q += harmonics[m].imag();
      state.v += (Complex(0.0, force.harmonics[m].order * force.omega) * harmonics[m]).imag();
    }
    return state;
  }
};

std::optional<Response> response_of(const dynamics::HybridSystem& system) {
  try {
    return Response(system);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

}  // namespace

dynamics::State linear_response(const dynamics::HybridSystem& system) { return Response(system).at_start(system); }

std::optional<GapMotion> GapMotion::of(const dynamics::HybridSystem& system) {
  const friction::Force* force = system.drive().force();
  const auto& contacts = system.contacts();
  const auto is_clearance = [](const friction::Contact& contact) {
    return friction::clearance(contact.law) != nullptr;
  };
  if (force == nullptr || contacts.empty() || !std::ranges::all_of(contacts, is_clearance)) return std::nullopt;
  const std::optional<Response> response = response_of(system);
  if (!response) return std::nullopt;
  GapMotion gap;
  const dynamics::State start = response->at_start(system);
  gap.steady_.resize(2 * system.size());
  gap.steady_ << start.q, start.v;
  const Eigen::Index n = system.size(), count = static_cast<Eigen::Index>(contacts.size());
  gap.tiny_ = 1e-9 * force->omega;
  gap.rates_.resize(2 * n);
  gap.vectors_.resize(2 * n, 2 * n);
  Eigen::Index k = 0;
  for (const FloquetMode& mode : floquet_modes(state_matrix(system.structure()))) {
    gap.rates_(k) = mode.multiplier;
    gap.vectors_.col(k++) = mode.direction;
  }
  // Without damping a floating structure drifts: its shift and its drift have one eigenvector.
  constexpr double kDependent = 1e-9;
  Eigen::FullPivLU<Eigen::MatrixXcd> factor(gap.vectors_);
  factor.setThreshold(kDependent);
  if (!factor.isInvertible() || gap.rates_.real().maxCoeff() > gap.tiny_) return std::nullopt;
  gap.to_parts_ = factor.inverse();

  gap.mean_.resize(count);
  gap.reach_.resize(count, 2);
  gap.seen_.resize(count, 2 * n);
  // A load that a floating structure carries away has no place to rest.
  constexpr double kBalanced = 1e-9;
  const Eigen::VectorXd& load = system.load();
  if (load.size() > 0 &&
      (fem::to_dense(system.structure().K()) * response->mean - load).norm() > kBalanced * load.norm()) {
    return std::nullopt;
  }
  for (Eigen::Index c = 0; c < count; ++c) {
    const friction::Contact& contact = contacts[static_cast<std::size_t>(c)];
    const friction::Clearance& law = *friction::clearance(contact.law);
    gap.mean_(c) = contact.direction.dot(response->mean) + contact.offset;
    gap.seen_.row(c) = contact.direction.transpose() * gap.vectors_.topRows(n);
    std::vector<Complex> coefficients;
    coefficients.reserve(response->harmonics.size());
    for (const Eigen::VectorXcd& one : response->harmonics) coefficients.push_back(contact.direction.dot(one));
    gap.reach_.row(c) = reach_of(coefficients, *force).transpose();
    if (law.right) gap.sides_.push_back({c, 1.0, law.right->gap});
    if (law.left) gap.sides_.push_back({c, -1.0, law.left->gap});
  }
  for (const Complex& rate : gap.rates_) {
    if (rate.real() < -gap.tiny_) continue;
    const bool shifts = std::abs(rate) <= gap.tiny_;
    if (gap.continuum_ != Continuum::kShift) gap.continuum_ = shifts ? Continuum::kShift : Continuum::kFree;
  }
  gap.set_middle();
  return gap;
}

Eigen::VectorXcd GapMotion::parts_of(const Eigen::VectorXd& x) const { return to_parts_ * (x - steady_); }

GapMotion::Room GapMotion::room_of(const Eigen::VectorXcd& parts, bool at_end) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Room found{kFar, kFar};
  for (const Side& stop : sides_) {
    double place = mean_(stop.clearance), swing = 0.0;
    for (Eigen::Index k = 0; k < parts.size(); ++k) {
      const Complex seen = seen_(stop.clearance, k) * parts(k);
      if (std::abs(rates_(k)) <= tiny_) {
        place += seen.real();
      } else if (!at_end || rates_(k).real() >= -tiny_) {
        swing += std::abs(seen);
      }
    }
    const double reach = reach_(stop.clearance, stop.side > 0.0 ? 0 : 1);
    const double room = stop.gap - stop.side * place - reach - swing;
    found.next = std::min(found.next, std::max(found.least, room));
    found.least = std::min(found.least, room);
  }
  return found;
}

double GapMotion::coordinate(const Eigen::VectorXd& x) const {
  if (continuum_ == Continuum::kNone) return 0.0;
  const Eigen::VectorXcd parts = parts_of(x);
  double place = mean_(0), swing = 0.0;
  for (Eigen::Index k = 0; k < parts.size(); ++k) {
    const Complex seen = seen_(0, k) * parts(k);
    if (std::abs(rates_(k)) <= tiny_) {
      place += seen.real();
    } else if (rates_(k).real() >= -tiny_) {
      swing += std::abs(seen);
    }
  }
  return continuum_ == Continuum::kShift ? place : swing;
}

void GapMotion::set_middle() {
  middle_ = steady_;
  if (continuum_ != Continuum::kShift) return;
  // Along each shift the room is concave and piecewise linear in the place: ternary search, one shift after the other.
  for (Eigen::Index k = 0; k < rates_.size(); ++k) {
    if (std::abs(rates_(k)) > tiny_) continue;
    const Eigen::VectorXd shift = vectors_.col(k).real();
    const double seen = seen_.col(k).cwiseAbs().maxCoeff();
    double span = 0.0;
    for (const Side& stop : sides_) span = std::max(span, std::abs(stop.gap) + mean_.cwiseAbs().maxCoeff());
    if (!(seen > 0.0)) continue;
    double low = -2.0 * span / seen, high = 2.0 * span / seen;
    for (int step = 0; step < 100; ++step) {
      const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
      const bool rises = room(middle_ + a * shift).least < room(middle_ + b * shift).least;
      (rises ? low : high) = rises ? a : b;
    }
    middle_ += 0.5 * (low + high) * shift;
  }
}

}  // namespace slipmode::orbits
