#include "dynamics/simulate.hpp"

#include "core/errors.hpp"
#include "dynamics/cache.hpp"
#include "dynamics/closed_form_flow.hpp"
#include "dynamics/collocation_flow.hpp"
#include "dynamics/load_form.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

void require(bool condition, const std::string& message) {
  if (!condition) throw InvalidInput(message);
}

void check_start(const HybridSystem& system, const State& start) {
  require(start.q.size() == system.size() && start.v.size() == system.size(),
          "start state has " + std::to_string(start.q.size()) + " displacements and " + std::to_string(start.v.size()) +
              " velocities; the system has " + std::to_string(system.size()) + " degrees of freedom");
  require(start.q.allFinite() && start.v.allFinite() && std::isfinite(start.time),
          "start state holds values that are not finite");
  require(start.internal.size() == 0 || start.internal.size() == system.internal_size(),
          "start state has " + std::to_string(start.internal.size()) + " contact states; the contacts have " +
              std::to_string(system.internal_size()));
  require(start.internal.allFinite(), "start state holds contact states that are not finite");
  require(start.modes.empty() || start.modes.size() == system.contacts().size(),
          "start state names the modes of " + std::to_string(start.modes.size()) + " contacts; the system has " +
              std::to_string(system.contacts().size()));
}

/// Modes at the start: as given, or by the sign of the sliding speed with zero speed left to consistency.
std::vector<ContactMode> start_modes(const HybridSystem& system, const State& start) {
  std::vector<ContactMode> modes(system.contacts().size());
  const double V = system.drive().velocity(start.time);
  for (std::size_t c = 0; c < modes.size(); ++c) {
    const auto& contact = system.contacts()[c];
    if (!contact_forces(contact).sticks()) {
      modes[c] = ContactMode::kSmooth;
      continue;
    }
    const double sliding = V - contact.direction.dot(start.v);
    const double scale =
        system.drive().velocity_scale(start.time) + contact.direction.cwiseAbs().dot(start.v.cwiseAbs());
    const ContactMode by_sign = std::abs(sliding) <= 1e-12 * scale ? ContactMode::kStick
                                : sliding > 0                      ? ContactMode::kSlipPositive
                                                                   : ContactMode::kSlipNegative;
    const bool compliant = contact_forces(contact).kind == ContactForces::Kind::kCompliant;
    if (start.modes.empty()) {
      modes[c] = compliant ? ContactMode::kStick : by_sign;
      continue;
    }
    modes[c] = start.modes[c];
    if (compliant || modes[c] == ContactMode::kSeparated) continue;  // decided by the force and the normal load
    const bool agrees = by_sign == ContactMode::kStick || modes[c] == by_sign ||
                        (modes[c] == ContactMode::kStick && std::abs(sliding) <= 1e-9 * std::max(1.0, scale));
    require(agrees && modes[c] != ContactMode::kSmooth,
            "start state says contact " + std::to_string(c + 1) + " is in mode " +
                std::to_string(static_cast<int>(modes[c])) + ", but its relative velocity is " +
                std::to_string(sliding) + "; leave the modes empty to have them derived");
  }
  return modes;
}

/// Above this size the closed form's changes of basis, O(n²) per event, cost more than they save.
constexpr Eigen::Index kClosedFormSize = 64;

FlowMethod choose_method(const HybridSystem& system, FlowMethod asked) {
  int special = 0, nonlinear = 0;  // the last such contact, counted from 1
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    const ContactForces law = contact_forces(system.contacts()[c]);
    if (law.needs_closed_form()) special = static_cast<int>(c) + 1;
    if (!law.is_piecewise_linear()) nonlinear = static_cast<int>(c) + 1;
  }
  const auto name = [](int contact) { return "contact " + std::to_string(contact); };
  require(special == 0 || nonlinear == 0,
          name(special) +
              " has a contact spring, a tilt or a varying load, for which all laws must be piecewise linear, but " +
              name(nonlinear) + " has a force that depends on the sliding speed");
  require(special == 0 || asked != FlowMethod::kCollocation,
          name(special) + " has a contact spring, a tilt or a varying load: use the closed-form flow");
  require(nonlinear == 0 || asked != FlowMethod::kClosedForm,
          "the closed-form flow needs piecewise-linear laws, but " + name(nonlinear) +
              " has a force that depends on the sliding speed; use the collocation flow, or Coulomb's law");
  if (asked != FlowMethod::kAutomatic) return asked;
  if (special > 0 || (nonlinear == 0 && system.size() <= kClosedFormSize)) return FlowMethod::kClosedForm;
  return FlowMethod::kCollocation;
}

/// The contacts' own states at the start: as given, or relaxed.
Eigen::VectorXd start_internal(const HybridSystem& system, const State& start) {
  if (start.internal.size() > 0) return start.internal;
  Eigen::VectorXd internal = Eigen::VectorXd::Zero(system.internal_size());
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    const friction::Contact& contact = system.contacts()[c];
    const LoadForm load(contact);
    if (!load.oscillates()) continue;
    const Eigen::Index own = system.internal_begin(static_cast<int>(c)) + friction::internal_states(contact) - 2;
    internal(own) = load.lift * (contact.direction.dot(start.q) + contact.offset) / load.stiffness;
  }
  return internal;
}

/// The modal model a run needs, and its state there.
struct Prepared {
  const ModelTables& tables;
  HybridPoint start;
  FlowOptions options;
};

Prepared prepare(const HybridSystem& system, const State& start, FlowOptions options, bool rows_suffice) {
  check_start(system, start);
  require(options.tolerance > 0 && std::isfinite(options.tolerance), "flow tolerance must be positive");
  require(options.max_events_per_window > 0, "max_events_per_window must be at least 1");
  const bool at_origin = start.q.isZero(0.0) && start.v.isZero(0.0);
  const ModelTables& tables = system.cache().tables(system, rows_suffice && at_origin);
  const ModalModel& m = tables.model;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * m.np);
  if (!at_origin) x = m.from_q * start.q + m.from_v * start.v;
  if (options.zeno_window == 0.0) options.zeno_window = 0.01 * 2.0 * std::numbers::pi / std::max(m.fastest, 1e-300);
  const auto nc = static_cast<Eigen::Index>(system.contacts().size());
  HybridPoint point{start.time,
                    std::move(x),
                    start_modes(system, start),
                    std::vector<int>(static_cast<std::size_t>(nc), 0),
                    Eigen::VectorXd::Zero(nc),
                    start_internal(system, start)};
  return {tables, std::move(point), options};
}

State physical(const ModalModel& m, const HybridPoint& point) {
  if (!m.has_shapes()) return {point.time, {}, {}, point.modes, point.internal};
  return {point.time, m.to_q * point.x, m.to_v * point.x, point.modes, point.internal};
}

/// Energy from the modal coordinates where they decouple it, else from the state.
double modal_energy(const HybridSystem& system, const ModalModel& m, const HybridPoint& point) {
  if (!m.proportional) return system.energy(physical(m, point));
  const Eigen::VectorXd& x = point.x;
  const auto eta = x.head(m.np), rate = x.tail(m.np);
  return 0.5 * rate.squaredNorm() + 0.5 * m.omega.cwiseProduct(eta).squaredNorm() - m.load.tail(m.np).dot(eta);
}

/// Keeps what the options ask for, sample by sample in blocks so that lifting to the degrees of freedom is one product.
class Recorder {
 public:
  Recorder(const SimulateOptions& options, const ModalModel& model, double start, Trajectory& out)
      : options_(options), model_(model), first_(start + options.transient), out_(out) {
    const bool all = options.output == SimulateOptions::Output::kAllDofs;
    if (options.sample > 0) {
      const double span = options.duration - options.transient;
      count_ = span < 0 ? 0 : static_cast<Eigen::Index>(std::floor(span / options.sample * (1 + 1e-12))) + 1;
      out.times.resize(count_);
      const Eigen::Index nc = model.contacts;
      out.contact_q.resize(nc, count_);
      out.contact_v.resize(nc, count_);
      out.lambda.resize(nc, count_);
      if (all) {
        out.q.resize(model.n, count_);
        out.v.resize(model.n, count_);
        block_.resize(2 * model.np, std::min<Eigen::Index>(kBlock, std::max<Eigen::Index>(count_, 1)));
      }
    }
    all_ = all;
  }

  [[nodiscard]] double next_time() const {
    return filled_ < count_ ? first_ + static_cast<double>(filled_) * options_.sample
                            : std::numeric_limits<double>::infinity();
  }

  void sample(double t, const Eigen::VectorXd& x, const Eigen::VectorXd& force) {
    out_.times(filled_) = t;
    out_.contact_q.col(filled_) = model_.displacement_row.transpose() * x + model_.contact_offset;
    out_.contact_v.col(filled_) = model_.velocity_row.transpose() * x;
    out_.lambda.col(filled_) = force;
    if (all_) {
      block_.col(filled_ - flushed_) = x;
      if (filled_ + 1 - flushed_ == block_.cols()) flush(filled_ + 1);
    }
    ++filled_;
  }

  void finish() {
    if (all_ && options_.sample > 0) flush(filled_);
    if (filled_ < count_) {  // stopped early
      out_.times.conservativeResize(filled_);
      for (auto* m : {&out_.contact_q, &out_.contact_v, &out_.lambda, &out_.q, &out_.v})
        if (m->cols() > 0) m->conservativeResize(Eigen::NoChange, filled_);
    }
  }

 private:
  static constexpr Eigen::Index kBlock = 256;

  void flush(Eigen::Index end) {
    const Eigen::Index count = end - flushed_;
    if (count > 0) {
      out_.q.middleCols(flushed_, count).noalias() = model_.to_q * block_.leftCols(count);
      out_.v.middleCols(flushed_, count).noalias() = model_.to_v * block_.leftCols(count);
    }
    flushed_ = end;
  }

  const SimulateOptions& options_;
  const ModalModel& model_;
  double first_;
  Trajectory& out_;
  Eigen::Index count_ = 0, filled_ = 0, flushed_ = 0;
  bool all_ = true;
  Eigen::MatrixXd block_;
};

/// One step of a flow; a failure is reported with the state in the structure's own degrees of freedom, (q, q̇).
template <class AnyFlow>
bool step(AnyFlow& flow, const ModalModel& m, double end) {
  try {
    return flow.step(end);
  } catch (const NumericalFailure& failure) {
    Eigen::VectorXd state;
    if (m.has_shapes() && failure.state.size() == 2 * m.np) {
      state.resize(2 * m.n);
      state << m.to_q * failure.state, m.to_v * failure.state;
    }
    throw NumericalFailure(failure.what(), failure.time, std::move(state), failure.residual);
  }
}

/// Runs one flow, whichever it is, to the end.
template <class AnyFlow>
void run(AnyFlow& flow, const HybridSystem& system, const ModalModel& m, const State& start,
         const SimulateOptions& options, Trajectory& out) {
  const double end = start.time + options.duration, keep_from = start.time + options.transient;
  Recorder recorder(options, m, start.time, out);
  out.audit.energy_start = modal_energy(system, m, flow.point());
  double largest_energy = std::abs(out.audit.energy_start);
  Eigen::VectorXd x(2 * m.np), force(m.contacts);
  std::vector<Eigen::VectorXd> event_q, event_v;
  bool going = true;
  while (going && flow.point().time < end) {
    const bool event = step(flow, m, end);
    while (recorder.next_time() <= flow.point().time) {
      const double t = recorder.next_time();
      flow.evaluate(t, x, force);
      recorder.sample(t, x, force);
    }
    if (!event) continue;
    if (options.flow.audit) largest_energy = std::max(largest_energy, std::abs(modal_energy(system, m, flow.point())));
    for (const Event& e : flow.events()) {
      if (e.time < keep_from) continue;
      if (options.keep_events) out.events.push_back(e);
      if (options.event_states) {
        const State s = physical(m, flow.point());
        event_q.push_back(s.q);
        event_v.push_back(s.v);
      }
      if (options.on_event && !options.on_event(e, physical(m, flow.point()))) going = false;
    }
  }
  while (recorder.next_time() <= end && going) {  // the last sample may lie a rounding error past the last step
    flow.evaluate(flow.point().time, x, force);
    recorder.sample(recorder.next_time(), x, force);
  }
  recorder.finish();
  if (options.event_states) {
    out.event_q.resize(m.n, static_cast<Eigen::Index>(event_q.size()));
    out.event_v.resize(m.n, static_cast<Eigen::Index>(event_v.size()));
    for (std::size_t k = 0; k < event_q.size(); ++k) {
      out.event_q.col(static_cast<Eigen::Index>(k)) = event_q[k];
      out.event_v.col(static_cast<Eigen::Index>(k)) = event_v[k];
    }
  }
  out.final_state = physical(m, flow.point());
  out.audit.energy_end = modal_energy(system, m, flow.point());
  out.audit.contact_work = flow.work().contact_work;
  out.audit.drive_work = flow.work().drive_work;
  out.audit.friction_loss = flow.work().drive_work - flow.work().contact_work;
  out.audit.viscous_loss = flow.work().viscous_loss;
  out.audit.exchanged = flow.work().exchanged + std::max(largest_energy, std::abs(out.audit.energy_end));
  out.statistics = flow.statistics();
}

}  // namespace

double EnergyAudit::residual() const {
  const double gap = energy_end - energy_start - contact_work + viscous_loss;
  return exchanged > 0 ? gap / exchanged : gap;
}

Trajectory simulate(const HybridSystem& system, const State& start, const SimulateOptions& options) {
  require(options.duration >= 0 && std::isfinite(options.duration), "duration must be finite and not negative");
  require(options.transient >= 0 && options.transient <= options.duration,
          "transient must lie between 0 and the duration");
  require(options.sample >= 0 && std::isfinite(options.sample), "sampling interval must be finite and not negative");
  const bool rows_suffice =
      options.output == SimulateOptions::Output::kContacts && !options.event_states && !options.on_event;
  const FlowMethod method = choose_method(system, options.flow.method);
  Prepared p = prepare(system, start, options.flow, rows_suffice && method == FlowMethod::kCollocation);
  Trajectory out;
  if (method == FlowMethod::kClosedForm) {
    ClosedFormFlow flow(system, std::move(p.start), p.options);
    run(flow, system, p.tables.model, start, options, out);
  } else {
    CollocationFlow flow(system, p.tables.steps, std::move(p.start), p.options);
    run(flow, system, p.tables.model, start, options, out);
  }
  return out;
}

TangentResult tangent_flow(const HybridSystem& system, const State& start, double duration,
                           const FlowOptions& options) {
  require(duration >= 0 && std::isfinite(duration), "duration must be finite and not negative");
  Prepared p = prepare(system, start, options, false);
  const ModalModel& m = p.tables.model;
  CollocationFlow flow(system, p.tables.steps, std::move(p.start), p.options);
  Eigen::MatrixXd basis(2 * m.np, 2 * m.n);
  basis << m.from_q, m.from_v;
  flow.set_tangents(std::move(basis));
  TangentResult out;
  const double end = start.time + duration;
  while (flow.point().time < end)
    if (step(flow, m, end)) out.events.insert(out.events.end(), flow.events().begin(), flow.events().end());
  out.end = physical(m, flow.point());
  out.monodromy.resize(2 * m.n, 2 * m.n);
  out.monodromy << m.to_q * flow.tangents(), m.to_v * flow.tangents();
  return out;
}

}  // namespace slipmode::dynamics
