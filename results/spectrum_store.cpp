#include <slipmode/results/spectrum_store.hpp>

#include <slipmode/core/to_vector.hpp>
#include "results/internal/field_record.hpp"

#include <fmt/format.h>

namespace slipmode::results {

std::vector<NamedHarmonics> named(const orbits::Spectrum& spectrum, const std::vector<std::string>& rows,
                                  const Units& units) {
  std::vector<NamedHarmonics> all;
  for (std::size_t c = 0; c < spectrum.displacement.size(); ++c) {
    const std::string at = fmt::format(" of contact {}", c + 1);
    all.push_back(
        {fmt::format("displacement_{}", c + 1), units.length, "displacement" + at, &spectrum.displacement[c]});
    all.push_back({fmt::format("velocity_{}", c + 1), units.velocity, "velocity" + at, &spectrum.velocity[c]});
    all.push_back({fmt::format("force_{}", c + 1), units.force, "force" + at, &spectrum.force[c]});
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::string at = " of degree of freedom " + rows[r];
    all.push_back({"q" + rows[r], units.length, "displacement" + at, &spectrum.row_displacement[r]});
    all.push_back({"v" + rows[r], units.velocity, "velocity" + at, &spectrum.row_velocity[r]});
  }
  return all;
}

Table harmonics_table(const std::vector<NamedHarmonics>& all) {
  Table table{.description = "y = sum over orders k of cosine cos(k omega t) + sine sin(k omega t)", .columns = {}};
  std::vector<double> orders;
  for (int k = 0; k <= all.front().harmonics->order(); ++k) orders.push_back(k);
  table.columns.push_back({"order", {"", "k"}, orders});
  for (const NamedHarmonics& own : all) {
    table.columns.push_back(
        {own.name + "_cosine", {own.unit, own.what + ", cosines"}, values_of(own.harmonics->cosine)});
    table.columns.push_back({own.name + "_sine", {own.unit, own.what + ", sines"}, values_of(own.harmonics->sine)});
  }
  return table;
}

orbits::Harmonics harmonics_of(const Table& table, const std::string& name) {
  return {to_vector(table.numbers(name + "_cosine")), to_vector(table.numbers(name + "_sine"))};
}

void store_spectrum(StoreWriter& store, const orbits::Spectrum& spectrum, const std::vector<NamedHarmonics>& all) {
  store.describe_group(kSpectrumGroup, "Fourier coefficients of a periodic orbit");
  save_fields(store, kSpectrumGroup, spectrum);
  save(store, fmt::format("{}/coefficients", kSpectrumGroup), harmonics_table(all));
}

Table load_spectrum(const StoreReader& store) {
  return load_table(store, fmt::format("{}/coefficients", kSpectrumGroup));
}

}  // namespace slipmode::results
