#include <slipmode/dynamics/simulate.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/prepare.hpp>
#include <slipmode/friction/engaged.hpp>
#include "dynamics/internal/closed_form_flow.hpp"
#include "dynamics/internal/collocation_flow.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

namespace slipmode::dynamics {
namespace {

void require(bool condition, const std::string& message) {
  if (!condition) throw InvalidInput(message);
}

/// Energy, and the larger of it and of what is stored, without constant loads' but in springs and stops of contacts
/// too: friction may do the work of a stop, and neither moves the structure.
struct Energy {
  Energy(double energy, double by_load, double in_contacts)
      : value(energy), size(std::max(std::abs(energy), energy + by_load) + in_contacts) {}

  double value, size;
};

/// What springs, bristles and stops of contacts store [J].
double stored_in_contacts(const HybridSystem& system, const ModalModel& m, const HybridPoint& point) {
  double stored = 0.0;
  for (int c = 0; c < m.contacts; ++c) {
    const friction::Law& law = system.contacts()[static_cast<std::size_t>(c)].law;
    if (const friction::Clearance* play = friction::clearance(law)) {
      const double y = m.displacement_row.col(c).dot(point.x) + m.contact_offset(c);
      const auto pressed = [&](const std::optional<friction::Stop>& stop, double outward) {
        const double past = stop ? std::max(0.0, outward - stop->gap) : 0.0;
        return stop ? 0.5 * stop->stiffness * past * past : 0.0;
      };
      stored += pressed(play->left, -y) + pressed(play->right, y);
    } else if (const double stiffness = friction::engaged_stiffness(law); stiffness > 0.0) {
      const double stretch = point.internal(system.internal_begin(c));
      stored += 0.5 * stiffness * stretch * stretch;
    }
  }
  return stored;
}

/// In natural modes: what a soft mode stores far out would be the small difference of large products with K.
Energy modal_energy(const HybridSystem& system, const ModalModel& m, const HybridPoint& point) {
  const auto of = [&](const auto& omega, const auto& load, const auto& eta, const auto& rate) {
    const double by_load = load.dot(eta);
    return Energy(0.5 * rate.squaredNorm() + 0.5 * omega.cwiseProduct(eta).squaredNorm() - by_load, by_load,
                  stored_in_contacts(system, m, point));
  };
  const Eigen::VectorXd& x = point.x;
  if (m.proportional) return of(m.omega, m.load.tail(m.np), x.head(m.np), x.tail(m.np));
  const ModalCoordinates& modal = m.modal;
  return of(modal.omega, modal.load, Eigen::VectorXd(modal.to_eta * x), Eigen::VectorXd(modal.to_eta_rate * x));
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
    const kernels::Kernels& vector = kernels::kernels();
    for (Eigen::Index c = 0; c < model_.contacts; ++c) {
      out_.contact_q(c, filled_) =
          vector.dot(model_.displacement_row.col(c).data(), x.data(), x.size()) + model_.contact_offset(c);
      out_.contact_v(c, filled_) = vector.dot(model_.velocity_row.col(c).data(), x.data(), x.size());
      out_.lambda(c, filled_) = force(c);
    }
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

/// Runs one flow, whichever it is, to the end.
template <class AnyFlow>
void run(AnyFlow& flow, const HybridSystem& system, const ModalModel& m, const State& start,
         const SimulateOptions& options, Trajectory& out) {
  const double end = start.time + options.duration, keep_from = start.time + options.transient;
  Recorder recorder(options, m, start.time, out);
  const Energy first = modal_energy(system, m, flow.point());
  out.audit.energy_start = first.value;
  const auto balance = [&](const WorkSums& work) {
    return out.audit.energy_start + work.contact_work + work.force_work - work.viscous_loss;
  };
  double largest_energy = first.size;
  Eigen::VectorXd x(2 * m.np), force(m.contacts);
  std::vector<Eigen::VectorXd> event_q, event_v;
  bool going = true;
  const auto tell_events = [&] {
    for (const Event& e : flow.events()) {
      if (options.on_event && !options.on_event(e, end_state(system, m, flow.point()))) going = false;
      if (e.time < keep_from) continue;
      if (options.keep_events) out.events.push_back(e);
      if (options.event_states) {
        const State s = physical(m, flow.point());
        event_q.push_back(s.q);
        event_v.push_back(s.v);
      }
    }
  };
  tell_events();
  while (going && flow.point().time < end) {
    const bool event = advance_flow(flow, m, end);
    while (recorder.next_time() <= flow.point().time) {
      const double t = recorder.next_time();
      flow.evaluate(t, x, force);
      recorder.sample(t, x, force);
    }
    if (!event) continue;
    // By the balance: it only scales the residual, and a state need not be turned back at every event for that.
    if (options.flow.audit) largest_energy = std::max(largest_energy, std::abs(balance(flow.work())));
    tell_events();
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
  out.final_state = end_state(system, m, flow.point());
  const Energy last = modal_energy(system, m, flow.point());
  out.audit.energy_end = last.value;
  out.audit.contact_work = flow.work().contact_work;
  out.audit.drive_work = flow.work().drive_work;
  out.audit.friction_loss = flow.work().drive_work - flow.work().contact_work;
  out.audit.force_work = flow.work().force_work;
  out.audit.viscous_loss = flow.work().viscous_loss;
  out.audit.exchanged = flow.work().exchanged + std::max(largest_energy, last.size);
  out.statistics = flow.statistics();
}

}  // namespace

double EnergyAudit::residual() const {
  const double gap = energy_end - energy_start - contact_work - force_work + viscous_loss;
  return exchanged > 0 ? gap / exchanged : gap;
}

Trajectory simulate(const HybridSystem& system, const State& start, const SimulateOptions& options) {
  require(options.duration >= 0 && std::isfinite(options.duration), "duration must be finite and not negative");
  require(options.transient >= 0 && options.transient <= options.duration,
          "transient must lie between 0 and the duration");
  require(options.sample >= 0 && std::isfinite(options.sample), "sampling interval must be finite and not negative");
  const bool rows_suffice =
      options.output == SimulateOptions::Output::kContacts && !options.event_states && !options.on_event;
  const FlowOptions flow_options = with_method(system, options.flow);
  const FlowMethod method = flow_options.method;
  Prepared p = prepare(system, start, flow_options, rows_suffice && method == FlowMethod::kCollocation);
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

State handed_on(const HybridSystem& system, const State& state, double time) {
  State begin{.time = time, .q = state.q, .v = state.v, .internal = state.internal};
  const auto is_compliant = [](const friction::Contact& contact) {
    return friction::kind(contact.law) == LawKind::kCompliant;
  };
  if (state.modes.empty() || std::ranges::none_of(system.contacts(), is_compliant)) return begin;
  begin.modes = simulate(system, begin, {.flow = {.audit = false}}).final_state.modes;
  for (std::size_t c = 0; c < begin.modes.size(); ++c)
    if (is_compliant(system.contacts()[c])) begin.modes[c] = state.modes[c];
  return begin;
}

}  // namespace slipmode::dynamics
