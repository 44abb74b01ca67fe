#pragma once

#include <slipmode/dynamics/modal_model.hpp>
#include <slipmode/dynamics/regime.hpp>

#include <Eigen/Core>
#include <complex>

namespace slipmode::dynamics {

/// Whether |det(iω − G_i)|, the determinant of a pair, is below this share of ω².
[[nodiscard]] bool resonates(const ModalModel& pairs, Eigen::Index pair, double omega, double share);

/// The same of any normal oscillator that moves by itself.
[[nodiscard]] bool any_oscillator_resonates(const Regime& regime, double omega, double share);

/// What a regime does under harmonic inputs, as phasors: value = Re(phasor · e^{iωt}).
struct HarmonicResponse {
  Eigen::VectorXcd slipping;     ///< state of the slipping model [2np_s]
  Eigen::VectorXcd force;        ///< λ of each contact [nc]
  Eigen::VectorXcd oscillators;  ///< ζ, ζ̇ of the normal oscillators, contact after contact [2k]
  Eigen::VectorXd place_size;    ///< of the terms that add up to each contact's wᵀq: held ones can cancel [nc]
};

/// The steady response at one frequency, by the receptances of the slipping structure at its contacts,
/// H = Uᵀ(iω − G)⁻¹B: with λ_c = Z_c (d_c − y_c),
///
///     λ_c / Z_c + Σ_d H_cd λ_d = d_c − (response to the forces)_c.
///
/// Where a contact is much stiffer than the structure, d − y is a small difference of large numbers, and what is left
/// of λ in phase with the velocity, the power, smaller still. Here nothing cancels: of forces on stiff contacts' places
/// the unknown is the sum with λ, which is what moves the structure. Pairs of the slipping structure
/// next to ω, whose share of H has no bound, are kept as unknowns beside λ: (iω − G_i) X_i = (B λ)_i + …
/// @param way     of the counterpart, d of the contacts that follow it
/// @param forces  along the directions of a force drive [nk]
/// Cost O(n nc²). Source: docs/theory/compliant-contacts.md, section 3.
/// @pre no oscillator's own frequency is next to ω
[[nodiscard]] HarmonicResponse harmonic_response(const Regime& regime, const ModalModel& slipping, double omega,
                                                 std::complex<double> way, const Eigen::VectorXcd& forces);

}  // namespace slipmode::dynamics
