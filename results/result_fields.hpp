#pragma once

// Field lists of results: what files, tables and JSON say of them, with the same names unless `stored_as` gives another
// one in files. Members that are not listed have no plain value, or belong to one of the places alone.

#include <slipmode/core/fields.hpp>
#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>
#include <slipmode/diagnostics/series/findings.hpp>
#include <slipmode/diagnostics/validation/driven_validation.hpp>
#include <slipmode/diagnostics/validation/validate.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/orbits/branches/continuation.hpp>
#include <slipmode/orbits/mixed/certificate.hpp>
#include <slipmode/orbits/skeleton_compare.hpp>
#include <slipmode/orbits/spectrum.hpp>
#include <slipmode/trade/clock.hpp>
#include <slipmode/trade/orbit_methods.hpp>
#include <slipmode/trade/schedule.hpp>

namespace slipmode {

namespace results {

/// Unit of times measured by a clock: they are seconds in dimensionless scenes too.
inline constexpr const char* kClockSeconds = "s of clock";

/// A time that a clock measured; its name outside files says the unit.
template <class S>
constexpr Field<S, double> timed(const char* name, double S::*member, const char* stored, const char* what) {
  return required(name, member, kClockSeconds, what).stored_as(stored);
}

}  // namespace results

template <>
inline constexpr auto kFields<dynamics::EnergyAudit> = [] {
  using Own = dynamics::EnergyAudit;
  return std::tuple{required("energy_start", &Own::energy_start, "J", "energy at the start"),
                    required("energy_end", &Own::energy_end, "J", "energy at the end"),
                    required("contact_work", &Own::contact_work, "J", "work of the contact forces on the structure"),
                    required("drive_work", &Own::drive_work, "J", "work of the drive"),
                    required("friction_loss", &Own::friction_loss, "J", "dissipated by friction"),
                    optional("force_work", &Own::force_work, "J", "work of a force drive"),
                    required("viscous_loss", &Own::viscous_loss, "J", "dissipated by damping"),
                    required("exchanged", &Own::exchanged, "J", "scale of the residual")};
}();

template <>
inline constexpr auto kFields<dynamics::FlowStatistics> = [] {
  using Own = dynamics::FlowStatistics;
  return std::tuple{required("steps", &Own::steps, "", "steps taken"),
                    required("rejected", &Own::rejected, "", "steps rejected"),
                    optional("certified", &Own::certified, "", "steps proved to pass over no event"),
                    required("events", &Own::events, "", "events located, kept or not"),
                    required("regimes_built", &Own::regimes_built, "", "regimes built"),
                    required("stick_time", &Own::stick_time, "s", "time in stick, per contact")};
}();

template <>
inline constexpr auto kFields<orbits::PeriodicOrbit> = [] {
  using Own = orbits::PeriodicOrbit;
  return std::tuple{
      required("period", &Own::period, "s", "period"),
      required("order", &Own::order, "", "period over that of the drive; 1 when self-excited", kFromZero),
      required("repeats", &Own::repeats, "", "how often a shorter orbit is passed within the period", kFromZero),
      required("trivial_multipliers", &Own::trivial_multipliers, "",
               "multipliers 1 that belong to a family, not to stability", kFromZero),
      required("leading_modulus", &Own::leading_modulus, "1", "largest modulus without the trivial ones"),
      required("zero_multipliers", &Own::zero_multipliers, "", "multipliers that are zero", kFromZero),
      required("superstable", &Own::superstable, "", "1: all but the trivial multipliers are zero", kFromZero),
      required("word", &Own::word, "", "cyclic sequence of regimes, a letter per contact"),
      required("crossings", &Own::crossings, "", "events that change the force law of a contact", kFromZero),
      required("symmetric", &Own::symmetric, "", "1: x(T/2) = -x(0)", kFromZero),
      required("asymmetry", &Own::asymmetry, "1", "mismatch of x(T/2) + x(0)"),
      required("grazing", &Own::grazing, "1", "least speed at which a stop is reached, relative"),
      required("has_grazing", &Own::has_grazing, "", "1: a grazing, or nearly one", kFromZero),
      required("family", &Own::family, "", "directions of the family it is one of, as columns; empty: isolated"),
      required("family_note", &Own::family_note, "", "the family in words; empty: isolated"),
      required("residual", &Own::residual, "1", "largest mismatch after a period, relative"),
      required("iterations", &Own::iterations, "", "Newton steps", kFromZero),
      required("residuals", &Own::residuals, "1", "before each Newton step and after the last")};
}();

template <>
inline constexpr auto kFields<orbits::Balance> = [] {
  using Own = orbits::Balance;
  return std::tuple{required("converged", &Own::converged, "", "1: Newton's method arrived", kFromZero),
                    required("order", &Own::order, "", "period over that of the drive", kCount),
                    required("omega", &Own::omega, "rad/s", "2 pi / period: order 1", kPositive),
                    required("harmonics", &Own::harmonics, "", "highest order", kCount),
                    required("samples", &Own::samples, "", "of the alternating scheme; 0: exact forces", kFromZero),
                    required("switches", &Own::switches, "", "of contact in a period", kFromZero),
                    required("family", &Own::family, "", "1: one of a family of motions that nothing holds", kFromZero),
                    required("stuck", &Own::stuck, "", "contacts behind springs that never slide", kFromZero),
                    required("residual", &Own::residual, "1", "largest, as a share of the largest displacement"),
                    required("iterations", &Own::iterations, "", "Newton steps", kFromZero)};
}();

template <>
inline constexpr auto kFields<orbits::MixedOrbit> = [] {
  using Own = orbits::MixedOrbit;
  return std::tuple{
      required("converged", &Own::converged, "", "1: Newton's method arrived", kFromZero),
      required("order", &Own::order, "", "period over that of the drive", kCount),
      required("omega", &Own::omega, "rad/s", "2 pi / period: order 1", kPositive),
      required("harmonics", &Own::harmonics, "", "highest order, far from the contacts", kCount),
      required("coupled", &Own::coupled, "", "degrees of freedom near the contacts that the rest pulls at", kFromZero),
      required("residual", &Own::residual, "1", "largest, in units of the motion"),
      required("iterations", &Own::iterations, "", "Newton steps", kFromZero)};
}();

template <>
inline constexpr auto kFields<orbits::OrderTrial> = [] {
  using Own = orbits::OrderTrial;
  return std::tuple{
      required("harmonics", &Own::harmonics, "", "highest order", kCount),
      required("error", &Own::error, "1", "true error as a share of the half range; NaN: no orbit behind"),
      required("iterations", &Own::iterations, "", "Newton steps", kFromZero)};
}();

template <>
inline constexpr auto kFields<orbits::Spectrum> = [] {
  using Own = orbits::Spectrum;
  return std::tuple{
      required("omega", &Own::omega, "rad/s", "2 pi / period of the orbit: order 1", kPositive),
      required("defect", &Own::defect, "1", "bound on the coefficients' error, as a share of their quantity")};
}();

template <>
inline constexpr auto kFields<orbits::Amplitude> = [] {
  using Own = orbits::Amplitude;
  return std::tuple{required("min", &Own::min, "m", "least displacement of contact"),
                    required("max", &Own::max, "m", "greatest displacement of contact"),
                    required("mean", &Own::mean, "m", "mean displacement of contact"),
                    required("alternating", &Own::alternating, "m", "half the range of contact"),
                    required("effective", &Own::effective, "m", "rms about the mean of contact")};
}();

template <>
inline constexpr auto kFields<orbits::Candidate> = [] {
  using Own = orbits::Candidate;
  return std::tuple{required("length", &Own::length, "", "passages per period, as guessed"),
                    required("period", &Own::period, "s", "period, as guessed"),
                    required("distance", &Own::distance, "1", "of the close return, in the attractor's metric"),
                    required("origin", &Own::origin, "", "where the candidate is from")};
}();

/// Differences; the numbers of both orbits are counted from 1 outside.
template <>
inline constexpr auto kFields<orbits::OrbitMatch> = [] {
  using Own = orbits::OrbitMatch;
  return std::tuple{
      required("period", &Own::period, "1", "difference of periods, relative"),
      required("log_multiplier", &Own::log_multiplier, "1", "difference of ln |leading multiplier|"),
      required("shape", &Own::shape, "1", "root mean square distance of the paths, relative to the full orbit's size"),
      required("share", &Own::share, "1", "difference of shares")};
}();

template <>
inline constexpr auto kFields<orbits::SpecialPoint> = [] {
  using Own = orbits::SpecialPoint;
  return std::tuple{
      required("uncertainty", &Own::uncertainty, "", "width of the last bracket; of a balance, of its own equations"),
      required("note", &Own::note, "", "what was seen")};
}();

template <>
inline constexpr auto kFields<diagnostics::VolumeBalance> = [] {
  using Own = diagnostics::VolumeBalance;
  return std::tuple{required("viscous", &Own::viscous, "1/s", "mean of the trace of the field, dashpots"),
                    required("friction", &Own::friction, "1/s", "the same, friction that depends on sliding speed"),
                    required("events", &Own::events, "1/s", "logarithms of what events do to volumes, per time"),
                    required("revived", &Own::revived, "1/s", "growth of directions that slip gave back"),
                    required("sum", &Own::sum, "1/s", "what they add up to"),
                    required("unexplained", &Own::unexplained, "", "events that are not accounted for")};
}();

template <>
inline constexpr auto kFields<diagnostics::LyapunovSpectrum> = [] {
  using Own = diagnostics::LyapunovSpectrum;
  return std::tuple{required("directions", &Own::size, "", "directions there are"),
                    required("lost", &Own::lost, "", "exponents of minus infinity"),
                    required("kaplan_yorke", &Own::dimension, "1", "Kaplan-Yorke dimension"),
                    required("kaplan_yorke_error", &Own::dimension_error, "1", "its error")};
}();

template <>
inline constexpr auto kFields<diagnostics::Finding> = [] {
  using Own = diagnostics::Finding;
  return std::tuple{required("quantity", &Own::quantity, "", "what it is"),
                    required("value", &Own::value, "", "value, in the row's unit"),
                    required("error", &Own::error, "", "its uncertainty"), required("unit", &Own::unit, "", "unit"),
                    required("settings", &Own::settings, "", "how it was come by")};
}();

/// Energies are compared outside.
template <>
inline constexpr auto kFields<diagnostics::Deviation> = [] {
  using Own = diagnostics::Deviation;
  return std::tuple{
      required("dX", &Own::dX, "%", "S4 (3.37) from shared starts up to the horizon, root mean square over the starts"),
      required("dE", &Own::dE, "%", "S4 (3.36), same runs"),
      required("dE_pointwise", &Own::dE_pointwise, "%", "root mean square difference of the energies")};
}();

/// Differences of stick and slips belong to JSON alone: tables have both models' own.
template <>
inline constexpr auto kFields<diagnostics::AttractorDistance> = [] {
  using Own = diagnostics::AttractorDistance;
  return std::tuple{required("wasserstein", &Own::wasserstein, "m", "distance of the slip states to the full model's"),
                    required("hausdorff", &Own::hausdorff, "m", "distance of the slip states to the full model's"),
                    required("mean_energy_percent", &Own::mean_energy_percent, "%",
                             "difference of the mean energy from the full model's")
                        .stored_as("mean_energy")};
}();

template <>
inline constexpr auto kFields<diagnostics::BifurcationComparison> = [] {
  using Own = diagnostics::BifurcationComparison;
  return std::tuple{required("values", &Own::values, "", "values with both results"),
                    required("failed", &Own::failed, "", "values without"),
                    required("decided", &Own::decided, "", "values where neither motion is undecided"),
                    required("same_motion", &Own::same_motion, "1",
                             "share of those decided with the same kind of motion; NaN: none is"),
                    required("same_period", &Own::same_period, "1", "the same with the same kind and period"),
                    required("periodic_full", &Own::periodic_full, "1", "share periodic in the full model"),
                    required("periodic_reduced", &Own::periodic_reduced, "1", "share periodic in the reduced model"),
                    required("mean_wasserstein", &Own::mean_wasserstein, "m", "mean distance of slip states"),
                    required("median_wasserstein", &Own::median_wasserstein, "m", "median distance"),
                    required("mean_hausdorff", &Own::mean_hausdorff, "m", "mean distance of slip states")};
}();

template <>
inline constexpr auto kFields<diagnostics::Cost> = [] {
  using Own = diagnostics::Cost;
  using results::timed;
  return std::tuple{required("duration", &Own::duration, "s", "simulated time of the timed run"),
                    timed("full_wall_s", &Own::full_wall, "full_wall", "median wall time, full model"),
                    timed("full_cpu_s", &Own::full_cpu, "full_cpu", "median CPU time, full model"),
                    timed("reduced_wall_s", &Own::reduced_wall, "reduced_wall", "median wall time, reduced model"),
                    timed("reduced_cpu_s", &Own::reduced_cpu, "reduced_cpu", "median CPU time, reduced model"),
                    timed("full_setup_wall_s", &Own::full_setup_wall, "full_setup_wall",
                          "wall time of the full model's modal data, once"),
                    timed("projection_wall_s", &Own::projection_wall, "projection_wall",
                          "wall time of the projection and its set-up, once")};
}();

/// Counts of values belong to JSON alone.
template <>
inline constexpr auto kFields<diagnostics::DrivenAgreement> = [] {
  using Own = diagnostics::DrivenAgreement;
  return std::tuple{
      required("mean_distance", &Own::mean_wasserstein, "1",
               "Wasserstein-1 distance of section points, mean over values"),
      required("median_distance", &Own::median_wasserstein, "1", "the same, median"),
      required("mean_hausdorff", &Own::mean_hausdorff, "1", "Hausdorff distance of section points, mean over values"),
      required("same_label", &Own::same_label, "1", "share of values with the same label"),
      required("same_period", &Own::same_period, "1", "share of values decided in both with the same period")};
}();

template <>
inline constexpr auto kFields<diagnostics::DrivenCost> = [] {
  using Own = diagnostics::DrivenCost;
  using results::timed;
  return std::tuple{timed("wall_s", &Own::wall, "wall", "median clock time of a timed run"),
                    timed("cpu_s", &Own::cpu, "cpu", "median processor time of a timed run"),
                    timed("setup_s", &Own::setup, "setup", "projection and modal data")};
}();

template <>
inline constexpr auto kFields<trade::RunCost> = [] {
  using Own = trade::RunCost;
  using results::timed;
  return std::tuple{timed("time_s", &Own::cpu, "time", "processor time of a timed run, median"),
                    timed("time_low_s", &Own::cpu_low, "time_low", "its least"),
                    timed("time_high_s", &Own::cpu_high, "time_high", "its largest"),
                    timed("wall_s", &Own::wall, "wall", "time of the clock, median"),
                    timed("setup_s", &Own::setup, "setup", "building, projection and modal data, once")};
}();

template <>
inline constexpr auto kFields<trade::OrbitRow> = [] {
  using Own = trade::OrbitRow;
  using results::timed;
  return std::tuple{
      required("name", &Own::name, "", "the way"),
      required("options", &Own::options, "", "of slipmode orbit find"),
      required("error_percent", &Own::error, "%", "sup over the period, of a contact's half range").stored_as("error"),
      timed("time_s", &Own::cpu, "time", "processor time of finding it, median"),
      timed("time_low_s", &Own::cpu_low, "time_low", "its least"),
      timed("time_high_s", &Own::cpu_high, "time_high", "its largest"),
      required("other", &Own::other, "", "regimes of the orbit behind, where it is another one"),
      required("failure", &Own::failure, "", "why it has no error; empty: it has")};
}();

template <>
inline constexpr auto kFields<trade::Schedule> = [] {
  using Own = trade::Schedule;
  return std::tuple{required("timed", &Own::timed, "s", "simulated by a timed run"),
                    required("recorded", &Own::duration, "s", "recorded of a settled motion"),
                    required("horizon", &Own::horizon, "s", "of dX and dE")};
}();

}  // namespace slipmode
