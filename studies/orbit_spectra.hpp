#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/orbits/spectrum.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/results/spectrum_store.hpp>
#include <slipmode/studies/family.hpp>

#include <memory>
#include <tuple>
#include <vector>

namespace slipmode::studies {

struct SpectrumRequest {
  int harmonics = 20;
  std::vector<int> dofs = {};  ///< whose displacement and velocity are asked for too, from 1

  static constexpr auto fields() {
    return std::tuple{
        optional("harmonics", &SpectrumRequest::harmonics, "", "highest order", {.low = 0.0, .high = 1e6})};
  }
};

struct OrbitSpectrum {
  orbits::Spectrum spectrum;
  std::vector<results::NamedHarmonics> quantities;  ///< of `spectrum`
};

/// Fourier coefficients of a stored orbit.
/// @param orbit  a result of find_orbit, found in the family's own model
/// @throws InvalidInput  for an orbit of another size, degrees of freedom that there are not; as orbits::orbit_spectrum
[[nodiscard]] std::shared_ptr<const OrbitSpectrum> orbit_spectrum(const Family& model,
                                                                  const results::StoreReader& orbit,
                                                                  const SpectrumRequest& request);

[[nodiscard]] results::Content content_of(const Family& model, std::shared_ptr<const OrbitSpectrum> spectrum,
                                          const SpectrumRequest& request);

}  // namespace slipmode::studies
