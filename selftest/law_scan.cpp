#include "selftest/law_scan.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/prepare.hpp>
#include "selftest/contact_guards.hpp"
#include "selftest/load_history.hpp"
#include "selftest/timeline.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <span>

namespace slipmode::selftest {
namespace {

using dynamics::ContactMode;
using Eigen::Index;

/// Rounding of a modal coordinate, of all of them together in the norm of energy.
constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();

/// Of what the flow's tolerance may leave a place off by, or guards are held to, what it tells a stop by.
constexpr double kShows = 10.0;

/// How far from its start a run may begin, of its sizes.
constexpr double kGivenBack = 1e-9;

/// A stretch of samples, apart by a constant interval.
struct Samples {
  Eigen::VectorXd times;
  Eigen::MatrixXd y, v, lambda;  ///< contacts x samples
  Eigen::MatrixXd acceleration;  ///< wᵀq̈
};

/// The polynomial through equidistant instants, `share` of their distance beyond the last.
ContactInstant continued(std::span<const ContactInstant> samples, double share) {
  ContactInstant out{};
  const auto n = static_cast<int>(samples.size());
  for (int j = 0; j < n; ++j) {
    double weight = 1.0;
    for (int i = 0; i < n; ++i)
      if (i != j) weight *= (share + n - 1 - i) / (j - i);
    for (double ContactInstant::*part : {&ContactInstant::y, &ContactInstant::v, &ContactInstant::slip,
                                         &ContactInstant::lambda, &ContactInstant::load, &ContactInstant::load_rate})
      out.*part += weight * (samples[static_cast<std::size_t>(j)].*part);
  }
  return out;
}

class Scan {
 public:
  Scan(const dynamics::HybridSystem& system, const dynamics::State& start, const dynamics::SimulateOptions& options,
       const dynamics::Trajectory& run, std::vector<Violation>& violations, const ScanLimits& limits)
      : system_(system), start_(start), options_(options), run_(run), violations_(violations), limits_(limits) {
    const auto nc = static_cast<Index>(system.contacts().size());
    W_.resize(system.size(), nc);
    for (Index c = 0; c < nc; ++c) W_.col(c) = system.contacts()[static_cast<std::size_t>(c)].direction;
    mass_ = fem::to_dense(system.structure().M());
    inverse_ = mass_.llt().solve(Eigen::MatrixXd::Identity(system.size(), system.size()));
    rows_ = W_.transpose() * inverse_;
    answer_ = free_answer();
    largest_place_ = largest(run.q);
    for (int c = 0; c < static_cast<int>(nc); ++c) timelines_.emplace_back(run, c);
    for (const dynamics::Event& e : run.events) event_times_.push_back(e.time);
  }

  ScanFigures run() {
    figures_.samples = run_.times.size();
    const Eigen::MatrixXd force = forces(run_.times, run_.q, run_.v, run_.lambda);
    const Samples samples{run_.times, run_.contact_q, run_.contact_v, run_.lambda, rows_ * force};
    check_motion(force);
    for (int c = 0; c < static_cast<int>(system_.contacts().size()); ++c) {
      if (timelines_[static_cast<std::size_t>(c)].broken())
        violate("sequence", fmt::format("contact {}: an event's `before` is not the mode it was in", c));
      figures_.events += static_cast<std::int64_t>(timelines_[static_cast<std::size_t>(c)].times().size());
      if (!is_idle(contact(c))) check_contact(c, samples);
    }
    return figures_;
  }

 private:
  [[nodiscard]] const friction::Contact& contact(int c) const {
    return system_.contacts()[static_cast<std::size_t>(c)];
  }

  void violate(const char* property, const std::string& what) {
    for (const Violation& known : violations_)
      if (known.property == property) return;
    violations_.push_back({property, what});
  }

  /// p + Σ d u − C q̇ − K q + Σ w λ, and the largest of its terms row by row.
  Eigen::MatrixXd forces(const Eigen::VectorXd& times, const Eigen::MatrixXd& q, const Eigen::MatrixXd& v,
                         const Eigen::MatrixXd& lambda) {
    const Eigen::MatrixXd elastic = fem::multiply(system_.structure().K(), q),
                          viscous = fem::multiply(system_.structure().C(), v), contact_forces = W_ * lambda;
    Eigen::MatrixXd total = contact_forces - elastic - viscous;
    force_scale_ = elastic.cwiseAbs().rowwise().maxCoeff() + viscous.cwiseAbs().rowwise().maxCoeff() +
                   contact_forces.cwiseAbs().rowwise().maxCoeff();
    if (system_.load().size() == system_.size()) {
      total.colwise() += system_.load();
      force_scale_ += system_.load().cwiseAbs();
    }
    if (const friction::Force* drive = system_.drive().force()) {
      for (Index d = 0; d < system_.force_directions().cols(); ++d) {
        for (Index k = 0; k < times.size(); ++k)
          total.col(k) += system_.force_directions().col(d) * drive->value(static_cast<int>(d), times(k));
        double amplitude = 0.0;
        for (const auto& harmonic : drive->harmonics) amplitude += harmonic.amplitude;
        force_scale_ += amplitude * system_.force_directions().col(d).cwiseAbs();
      }
    }
    return total;
  }

  /// |M^½ x|, the largest of all columns.
  [[nodiscard]] double largest(const Eigen::MatrixXd& x) const {
    return std::sqrt(x.cwiseProduct(mass_ * x).colwise().sum().maxCoeff());
  }

  /// True when no event lies within [from, to].
  [[nodiscard]] bool quiet(double from, double to) const {
    const auto next = std::ranges::lower_bound(event_times_, from);
    return next == event_times_.end() || *next > to;
  }

  /// Momentum and displacement over four intervals by Boole's rule, which is Simpson's with the error that half its
  /// step shows taken off. That error, and the rounding of modal coordinates in the norm of energy, are no residual.
  void check_motion(const Eigen::MatrixXd& force) {
    const Eigen::MatrixXd momentum = mass_ * run_.v;
    const double h = options_.sample;
    // Rows have units of their own; one in which nothing happens is measured by the others.
    const auto floored = [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
      return x.array() + 1e-6 * x.maxCoeff() + 1e-300;
    };
    const Eigen::VectorXd speed_scale = floored(run_.v.cwiseAbs().rowwise().maxCoeff()), scale = floored(force_scale_);
    // In closed form a motion rounds by the steady answer to its drive, beside which a short record from rest has next
    // to none.
    std::optional<dynamics::Trajectory> cycle;
    const dynamics::FlowMethod method = dynamics::choose_method(system_, options_.flow.method);
    const std::optional<double> period = system_.drive().period();
    if (method == dynamics::FlowMethod::kClosedForm && period && *period > options_.duration)
      cycle = dynamics::simulate(system_, start_,
                                 {.duration = *period,
                                  .sample = *period / 64.0,
                                  .keep_events = false,
                                  .flow = {.method = method, .audit = false}});
    const dynamics::Trajectory& whole = cycle ? *cycle : run_;
    // Speeds round by the energy of the motion, displacements' included; and by what the run makes of its own start.
    const Eigen::MatrixXd elastic = fem::multiply(system_.structure().K(), whole.q);
    const double swing = std::hypot(largest(whole.v),
                                    std::sqrt(std::max(0.0, whole.q.cwiseProduct(elastic).colwise().sum().maxCoeff())));
    const Eigen::VectorXd own_q = (run_.q.col(0) - start_.q).cwiseAbs(), own_v = (run_.v.col(0) - start_.v).cwiseAbs();
    const double given_back = std::max(own_q.maxCoeff() / whole.q.cwiseAbs().maxCoeff(),
                                       own_v.maxCoeff() / (whole.v.cwiseAbs().maxCoeff() + swing));
    if (given_back > kGivenBack) violate("start", fmt::format("the run begins {:.2g} from its start", given_back));
    // From one step to the next a run may err by its tolerance, of the whole motion: that is a row's own that hardly
    // moves.
    const double error = kRounding + options_.flow.tolerance;
    // A state under a force is the sum of the free structure's answer and what contacts take from it, which may be all.
    const Eigen::VectorXd tolerated = W_.cwiseAbs() * tolerated_impulses(system_, options_.flow);
    const Eigen::VectorXd momentum_rounding = error * swing * mass_.diagonal().cwiseSqrt() +
                                              4.0 * h * kRounding * force_sizes() + tolerated +
                                              mass_.cwiseAbs() * (4.0 * own_v + kRounding * answer_.col(1)),
                          way_rounding = error * largest(whole.q) * inverse_.diagonal().cwiseSqrt() + 4.0 * own_q +
                                         kRounding * answer_.col(0) + 4.0 * h * (inverse_.cwiseAbs() * tolerated);
    const auto excess = [&](const Eigen::MatrixXd& rate, const Eigen::MatrixXd& sum, Index k, Index apart,
                            const Eigen::VectorXd& rounding) -> Eigen::VectorXd {
      const double step = static_cast<double>(apart) * h;
      const auto at = [&](int i) { return rate.col(k + i * apart); };
      const Eigen::VectorXd ends = at(0) + at(4);
      const Eigen::VectorXd coarse = 2.0 * step / 3.0 * (ends + 4.0 * at(2));
      const Eigen::VectorXd fine = step / 3.0 * (ends + 2.0 * at(2) + 4.0 * (at(1) + at(3)));
      const Eigen::VectorXd correction = (fine - coarse) / 15.0;
      const Eigen::VectorXd residual = fine + correction - sum.col(k + 4 * apart) + sum.col(k);
      return (residual.cwiseAbs() - correction.cwiseAbs() - rounding).cwiseMax(0.0) / (4.0 * step);
    };
    const auto judged = [&](Index k, Index apart) {
      return k + 4 * apart < run_.times.size() && quiet(run_.times(k), run_.times(k + 4 * apart)) &&
             smooth_drive(run_.times(k), run_.times(k + 4 * apart));
    };
    const auto residual_at = [&](Index k, Index apart) {
      return std::max(excess(force, momentum, k, apart, momentum_rounding).cwiseQuotient(scale).maxCoeff(),
                      excess(run_.v, run_.q, k, apart, way_rounding).cwiseQuotient(speed_scale).maxCoeff());
    };
    for (Index k = 0; k + 4 < run_.times.size(); ++k) {
      if (!judged(k, 1)) continue;
      double residual = residual_at(k, 1);
      // Rounding of what a state is a sum of, far larger than itself, is the smaller the longer the interval is.
      if (residual > limits_.motion && judged(k, 4)) residual = std::min(residual, residual_at(k, 4));
      figures_.motion = std::max(figures_.motion, residual);
      if (residual > limits_.motion)
        violate("motion", fmt::format("residual {:.2g} of the equations of motion at t = {:.9g}, modes {}", residual,
                                      run_.times(k + 2), modes_at(run_.times(k + 2))));
    }
  }

  /// Bounds on displacements and speeds of the steady answer to a force with all contacts free.
  [[nodiscard]] Eigen::MatrixXd free_answer() const {
    Eigen::MatrixXd bound = Eigen::MatrixXd::Zero(system_.size(), 2);
    const friction::Force* drive = system_.drive().force();
    if (drive == nullptr) return bound;
    const fem::Structure& structure = system_.structure();
    const Eigen::MatrixXcd M = fem::to_dense(structure.M()), C = fem::to_dense(structure.C()),
                           K = fem::to_dense(structure.K());
    for (const auto& harmonic : drive->harmonics) {
      const std::complex<double> rate(0.0, harmonic.order * drive->omega);
      const Eigen::VectorXcd direction = harmonic.amplitude * system_.force_directions().col(harmonic.direction);
      const Eigen::VectorXd q = (K + rate * C + rate * rate * M).lu().solve(direction).cwiseAbs();
      if (!q.allFinite()) continue;  // at a resonance without damping there is none
      bound.col(0) += q;
      bound.col(1) += std::abs(rate) * q;
    }
    return bound;
  }

  /// What forces are differences of, row by row: |K| |q| + |C| |v| + Σ |w| k |y|, k of contact springs.
  [[nodiscard]] Eigen::VectorXd force_sizes() const {
    const auto sizes = [](const fem::Matrix& A, const Eigen::MatrixXd& x) -> Eigen::VectorXd {
      return fem::to_dense(A).cwiseAbs() * x.cwiseAbs().rowwise().maxCoeff();
    };
    Eigen::VectorXd sum = sizes(system_.structure().K(), run_.q) + sizes(system_.structure().C(), run_.v);
    for (Index c = 0; c < W_.cols(); ++c)
      sum += friction::spring_stiffness(contact(static_cast<int>(c)).law) *
             run_.contact_q.row(c).cwiseAbs().maxCoeff() * W_.col(c).cwiseAbs();
    return sum;
  }

  [[nodiscard]] std::string modes_at(double t) const {
    std::string text;
    for (const Timeline& timeline : timelines_)
      text += fmt::format("{}{}", text.empty() ? "" : " ", static_cast<int>(timeline.at(t)));
    return text;
  }

  [[nodiscard]] bool smooth_drive(double from, double to) const {
    const auto corner = system_.drive().next_corner(from - 1e-12);
    return !corner || *corner > to;
  }

  /// How deep in a stop a contact's place may be before a flow tells. By collocation some times what its tolerance may
  /// leave the place off by, impulses for a step: one at contact d gives c no more than √(m_c m_d) times as much of a
  /// speed, by the energy it brings. In closed form a share of what the drive swings it by in the long run, which a
  /// motion from rest is the small difference of with free motion; no more than some times what guards are held to.
  [[nodiscard]] double tolerated_place(int c, double way) const {
    if (dynamics::choose_method(system_, options_.flow.method) == dynamics::FlowMethod::kClosedForm) {
      const friction::Shaker* shaker = system_.drive().shaker();
      const double swings = W_.col(c).cwiseAbs().dot(answer_.col(0)) +
                            (shaker != nullptr ? shaker->amplitude * W_.col(c).lpNorm<1>() : 0.0);
      return std::min(kTold * swings, kShows * limits_.guard * way);
    }
    const Eigen::VectorXd reach = (rows_ * W_).diagonal().cwiseSqrt();
    const double speed = reach(c) * reach.dot(tolerated_impulses(system_, options_.flow));
    const dynamics::StepTables& steps = system_.cache().tables(system_, false).steps;
    return speed == 0.0 ? 0.0
                        : kShows * speed * std::min(steps.acting_time(system_.drive().omega()), options_.duration);
  }

  ContactScales scales_of(int c) const {
    const friction::Contact& law = contact(c);
    double drive = 0.0;
    for (Index k = 0; k < run_.times.size(); ++k)
      drive = std::max(drive, std::abs(system_.drive().velocity(run_.times(k))));
    ContactScales scales;
    // A place is the sum of what all modes move it by: |terms|₁ ≤ √n |terms|₂.
    const double moved = largest_place_ * std::sqrt(rows_.row(c).dot(W_.col(c)));
    // What is held, or hardly moves, has a place that is told by the motion around it, and by what the speeds of its
    // sides make of that within a radian of the fastest mode. A flow tells a stop from it to 1e-11 of these terms.
    const Eigen::VectorXd speeds = run_.v.cwiseAbs().rowwise().maxCoeff();
    const double fastest = system_.cache().tables(system_, false).model.fastest,
                 soon = fastest > 0.0 ? W_.col(c).cwiseAbs().dot(speeds) / fastest : 0.0;
    scales.way = run_.contact_q.row(c).cwiseAbs().maxCoeff() +
                 1e-3 * (run_.q.cwiseAbs().maxCoeff() + soon + std::sqrt(static_cast<double>(run_.q.rows())) * moved);
    // Where all is all but at rest, speeds round by what displacements would become.
    const double rounding =
        std::numeric_limits<double>::epsilon() / limits_.law / options_.sample * run_.q.cwiseAbs().maxCoeff();
    scales.speed = W_.col(c).cwiseAbs().dot(speeds) + 1e-3 * speeds.maxCoeff() + drive + rounding;
    const double static_limit = friction::static_coefficient(law.law) * law.normal_load.constant;
    scales.force = std::max(static_limit, run_.lambda.row(c).cwiseAbs().maxCoeff());
    if (!law.normal_load.is_constant()) scales.force = std::max(scales.force, law.normal_load.constant);
    if (const friction::Clearance* clearance = friction::clearance(law.law)) {
      for (const friction::Stop& stop : clearance->stops()) {
        scales.way = std::max(scales.way, std::abs(stop.gap));
        scales.force = std::max(scales.force, stop.stiffness * scales.way + stop.damping * scales.speed);
      }
    }
    for (double* scale : {&scales.way, &scales.speed, &scales.force})
      if (!(*scale > 0.0)) *scale = 1.0;
    scales.place = tolerated_place(c, scales.way);
    scales.slack = kRounding * friction::spring_stiffness(law.law) * std::max(scales.way, moved);
    return scales;
  }

  [[nodiscard]] ContactInstant instant(int c, const Samples& s, Index k, const LoadHistory& load) const {
    ContactInstant now{.y = s.y(c, k), .v = s.v(c, k), .lambda = s.lambda(c, k)};
    now.slip = system_.drive().velocity(s.times(k)) - now.v;
    load.read(now.y, now.v, s.acceleration(c, k), now);
    return now;
  }

  void check_contact(int c, const Samples& s) {
    const ContactScales scales = scales_of(c);
    const Timeline& timeline = timelines_[static_cast<std::size_t>(c)];
    LoadHistory load(contact(c).normal_load, W_.col(c).dot(start_.q) + contact(c).offset);
    Eigen::VectorXd guards(s.times.size());
    std::vector<ContactInstant> instants;
    std::vector<LoadHistory> recent;  // at samples k − 2, k − 1
    for (Index k = 0; k < s.times.size(); ++k) {
      if (k > 0) load = carried(c, load, s, k);
      const double t = s.times(k);
      instants.push_back(instant(c, s, k, load));
      if (!quiet(t, t)) {  // the sample may belong to either side
        guards(k) = 1.0;
      } else {
        const LawCheck check = check_law(contact(c), timeline.at(t), instants.back(), scales);
        guards(k) = check.guard;
        note(c, t, check);
        figures_.coasts |= k > 0 && coasts(c, timeline.at(t), instants[instants.size() - 2], instants.back(), scales);
      }
      if (k >= 2) look_between(c, s, k, guards, recent.front(), scales);
      recent.push_back(load);
      if (recent.size() > 2) recent.erase(recent.begin());
    }
    check_event_guards(c, s, instants, scales);
  }

  /// What slides to where sliding friction, or none, holds it ends at what sticks only if it comes to rest. By dampers
  /// alone it never does: once its speed is rounding, from one sample to the next, that says whether it turns.
  [[nodiscard]] bool coasts(int c, ContactMode mode, const ContactInstant& last, const ContactInstant& now,
                            const ContactScales& scales) const {
    const bool slides = mode == ContactMode::kSlipPositive || mode == ContactMode::kSlipNegative;
    return slides && std::max(std::abs(last.slip), std::abs(now.slip)) <= kRounding * scales.speed &&
           friction::static_coefficient(contact(c).law) > 0.0;
  }

  void note(int c, double t, const LawCheck& check) {
    figures_.guard = std::max(figures_.guard, -check.guard);
    figures_.law = std::max(figures_.law, check.law);
    if (-check.guard > limits_.guard)
      violate("missed event",
              fmt::format("contact {}: a guard is {:.2g} below zero at t = {:.9g}", c, -check.guard, t));
    if (check.law > limits_.law)
      violate("law", fmt::format("contact {}: off its law by {:.2g} at t = {:.9g}", c, check.law, t));
  }

  /// The load carried from sample k − 1 to k, through the events between.
  LoadHistory carried(int c, LoadHistory load, const Samples& s, Index k) const {
    if (!contact(c).normal_load.oscillator) return load;
    double t = s.times(k - 1), y = s.y(c, k - 1), v = s.v(c, k - 1);
    auto event = std::ranges::upper_bound(event_times_, t);
    for (; event != event_times_.end() && *event < s.times(k); ++event) {
      const Index i = event - event_times_.begin();
      const double ye = W_.col(c).dot(run_.event_q.col(i)) + contact(c).offset, ve = W_.col(c).dot(run_.event_v.col(i));
      load.advance(*event - t, y, v, ye, ve);
      t = *event;
      y = ye;
      v = ve;
    }
    load.advance(s.times(k) - t, y, v, s.y(c, k), s.v(c, k));
    return load;
  }

  /// Where samples k − 2 … k show a minimum whose parabola goes below zero: looks 256 times finer.
  void look_between(int c, const Samples& s, Index k, const Eigen::VectorXd& guards, const LoadHistory& load,
                    const ContactScales& scales) {
    const double a = guards(k - 2), b = guards(k - 1), d = guards(k), curvature = a - 2.0 * b + d;
    if (b > a || b > d || b <= 0.0 || curvature <= 0.0 || b - (a - d) * (a - d) / (8.0 * curvature) > limits_.guard)
      return;
    if (!quiet(s.times(k - 2), s.times(k))) return;
    ++figures_.minima;
    dynamics::SimulateOptions options = options_;
    options.transient = s.times(k - 2) - start_.time;
    options.sample = (s.times(k) - s.times(k - 2)) / 512.0;
    options.duration = s.times(k) - start_.time;
    options.flow.audit = false;
    const dynamics::Trajectory fine = dynamics::simulate(system_, start_, options);
    const Eigen::MatrixXd force = forces(fine.times, fine.q, fine.v, fine.lambda);
    const Samples look{fine.times, fine.contact_q, fine.contact_v, fine.lambda, rows_ * force};
    const ContactMode mode = timelines_[static_cast<std::size_t>(c)].at(s.times(k - 1));
    LoadHistory here = load;
    for (Index j = 0; j < look.times.size(); ++j) {
      if (j > 0)
        here.advance(look.times(j) - look.times(j - 1), look.y(c, j - 1), look.v(c, j - 1), look.y(c, j), look.v(c, j));
      note(c, look.times(j), check_law(contact(c), mode, instant(c, look, j, here), scales));
    }
  }

  /// The guards of a mode that ends must vanish at its end, where its last samples are continued to. The samples are,
  /// not the least of the guards: that has kinks where guards change places.
  void check_event_guards(int c, const Samples& s, const std::vector<ContactInstant>& instants,
                          const ContactScales& scales) {
    const double h = options_.sample;
    const Timeline& timeline = timelines_[static_cast<std::size_t>(c)];
    for (std::size_t i = 0; i < timeline.times().size(); ++i) {
      const double t = timeline.times()[i];
      const auto k = static_cast<Index>(std::ceil((t - s.times(0)) / h)) - 1;
      // One contact's event may set off another's, or its own next.
      const double instant = 1e-12 * (1.0 + t);
      const auto first = std::lower_bound(event_times_.begin(), event_times_.end(), t - instant),
                 last = std::upper_bound(first, event_times_.end(), t + instant);
      if (last - first > 1 || k < 4 || k >= s.times.size() || !quiet(s.times(k - 4), t - instant) ||
          !smooth_drive(s.times(k - 4), t) || t - s.times(k) < 1e-9 * h)
        continue;
      const std::span<const ContactInstant> samples(instants.data() + k - 4, 5);
      const auto guard_by = [&](std::size_t points) {
        return check_law(contact(c), timeline.before(i), continued(samples.last(points), (t - s.times(k)) / h), scales)
            .guard;
      };
      // By five points, and by four and three to know how far that can be trusted: what five leave out is less than
      // what the fifth or the fourth changes, one of which may happen to change nothing, as long as samples resolve the
      // motion.
      const double at = guard_by(5), by_four = guard_by(4);
      const double changed = std::max(std::abs(at - by_four), std::abs(by_four - guard_by(3)));
      const double excess = std::max(0.0, std::abs(at) - 4.0 * changed);
      figures_.spurious = std::max(figures_.spurious, excess);
      if (excess > limits_.spurious)
        violate("spurious event", fmt::format("contact {}: its guard is {:.2g} at the event at t = {:.9g}", c, at, t));
    }
  }

  const dynamics::HybridSystem& system_;
  const dynamics::State& start_;
  const dynamics::SimulateOptions& options_;
  const dynamics::Trajectory& run_;
  std::vector<Violation>& violations_;
  ScanLimits limits_;
  ScanFigures figures_;
  Eigen::MatrixXd W_, mass_, inverse_, rows_;
  Eigen::MatrixXd answer_;      ///< free_answer()
  double largest_place_ = 0.0;  ///< |M^½ q| of the run
  Eigen::VectorXd force_scale_;
  std::vector<Timeline> timelines_;
  std::vector<double> event_times_;
};

}  // namespace

void ScanFigures::merge(const ScanFigures& other) {
  guard = std::max(guard, other.guard);
  law = std::max(law, other.law);
  motion = std::max(motion, other.motion);
  spurious = std::max(spurious, other.spurious);
  samples += other.samples;
  minima += other.minima;
  events += other.events;
  coasts |= other.coasts;
}

Eigen::VectorXd tolerated_impulses(const dynamics::HybridSystem& system, const dynamics::FlowOptions& flow,
                                   double longest) {
  const auto nc = static_cast<Index>(system.contacts().size());
  const dynamics::ModelTables& own = system.cache().tables(system, false);
  Eigen::VectorXd most = Eigen::VectorXd::Zero(nc);
  if (own.model.fastest == 0.0 || dynamics::choose_method(system, flow.method) == dynamics::FlowMethod::kClosedForm)
    return most;
  for (Index c = 0; c < nc; ++c)
    most(c) = friction::contact_forces(system.contacts()[static_cast<std::size_t>(c)]).most();
  return flow.tolerance * std::min(own.steps.acting_time(system.drive().omega()), longest) * most;
}

ScanFigures scan_run(const dynamics::HybridSystem& system, const dynamics::State& start,
                     const dynamics::SimulateOptions& options, const dynamics::Trajectory& run,
                     std::vector<Violation>& out_violations, const ScanLimits& limits) {
  return Scan(system, start, options, run, out_violations, limits).run();
}

}  // namespace slipmode::selftest
