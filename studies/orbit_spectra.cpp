#include <slipmode/studies/orbit_spectra.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/orbit_records.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/studies/command.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string>
#include <utility>

namespace slipmode::studies {
namespace {

Eigen::MatrixXd rows_of(const std::vector<int>& dofs, Eigen::Index n) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(dofs.size()));
  for (std::size_t r = 0; r < dofs.size(); ++r) {
    if (dofs[r] < 1 || dofs[r] > n)
      throw InvalidInput(fmt::format("--dof {}: the model has degrees of freedom 1 to {}", dofs[r], n));
    rows(dofs[r] - 1, static_cast<Eigen::Index>(r)) = 1.0;
  }
  return rows;
}

}  // namespace

std::shared_ptr<const OrbitSpectrum> orbit_spectrum(const Family& model, const results::StoreReader& store,
                                                    const SpectrumRequest& request) {
  const orbits::PeriodicOrbit orbit = results::load_orbit(store);
  const Eigen::Index n = model.own().size();
  if (orbit.start.q.size() != n) {
    throw InvalidInput(fmt::format(
        "'{}' holds an orbit of {} degrees of freedom and the {} has {}; say with --model what it was found with",
        store.path().string(), orbit.start.q.size(), model.title(), n));
  }
  const auto out = std::make_shared<OrbitSpectrum>(
      OrbitSpectrum{orbits::orbit_spectrum(model.own(), orbit, request.harmonics, rows_of(request.dofs, n)), {}});
  std::vector<std::string> names;
  for (const int dof : request.dofs) names.push_back(std::to_string(dof));
  out->quantities = results::named(out->spectrum, names, results::Units::of(model.scene().units));
  return out;
}

results::Content content_of(const Family& model, std::shared_ptr<const OrbitSpectrum> spectrum,
                            const SpectrumRequest& request) {
  const std::string dofs = request.dofs.empty() ? "" : fmt::format(" --dof {}", fmt::join(request.dofs, ","));
  return {.kind = results::FileKind::kSpectrum,
          .unit_system = model.scene().units,
          .write = [provenance =
                        results::provenance_of(model.scene(), "slipmode orbit spectrum" + options_text(request) + dofs),
                    spectrum = std::move(spectrum)](results::StoreWriter& writer) {
            results::save(writer, provenance);
            results::store_spectrum(writer, spectrum->spectrum, spectrum->quantities);
          }};
}

}  // namespace slipmode::studies
