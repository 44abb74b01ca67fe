#include <slipmode/results/balance_store.hpp>

#include <slipmode/results/spectrum_store.hpp>
#include "results/internal/field_record.hpp"

#include <fmt/format.h>
#include <tuple>

namespace slipmode::results {
namespace {

std::string path(const char* name) { return fmt::format("{}/{}", kBalanceGroup, name); }

/// Orders tried and, where there is a certificate, what it says.
void store_certified(StoreWriter& store, const std::string& group, const orbits::Certificate* certificate,
                     const std::vector<orbits::OrderTrial>& trials, const Units& units) {
  save(store, group + "/trials", Table{"orders tried, and their true errors", columns_of(trials)});
  if (certificate == nullptr) return;
  store.write(group + "/verdict", certificate->verdict, {"", "what shooting from it says"});
  store.write(group + "/error", certificate->error, {units.length, "sup |y - exact| over the period, per contact"});
}

}  // namespace

void store_balance(StoreWriter& store, const orbits::Balance& balance, const orbits::Certificate* certificate,
                   const std::vector<orbits::OrderTrial>& trials, const Units& units) {
  std::vector<NamedHarmonics> all;
  for (std::size_t c = 0; c < balance.displacement.size(); ++c)
    for (const auto& [word, unit, own] : {std::tuple{"displacement", units.length, &balance.displacement[c]},
                                          std::tuple{"force", units.force, &balance.force[c]}})
      all.push_back({fmt::format("{}_{}", word, c + 1), unit, fmt::format("{} of contact {}", word, c + 1), own});
  store.describe_group(kBalanceGroup, "a truncated Fourier series that balances the equations of motion");
  save_fields(store, kBalanceGroup, balance);
  save(store, path("coefficients"), harmonics_table(all));
  store_certified(store, kBalanceGroup, certificate, trials, units);
}

void store_mixed(StoreWriter& store, const orbits::MixedOrbit& mixed, const std::vector<std::string>& near,
                 const orbits::Certificate& certificate, const std::vector<orbits::OrderTrial>& trials,
                 const Units& units) {
  store.describe_group(kMixedGroup, "the motion this orbit lies behind: exact near the contacts, harmonics elsewhere");
  save_fields(store, kMixedGroup, mixed);
  store.write(fmt::format("{}/near", kMixedGroup), near, {"", "degrees of freedom in the time domain"});
  store.write(fmt::format("{}/relative", kMixedGroup), certificate.relative,
              {"1", "largest error, a share of its contact's half range"});
  store_certified(store, kMixedGroup, &certificate, trials, units);
}

StoredBalance load_balance(const StoreReader& store) {
  StoredBalance out{
      .omega = store.number(path("omega")), .displacement = {}, .trials = load_table(store, path("trials"))};
  const Table table = load_table(store, path("coefficients"));
  for (std::size_t c = 1; table.has(fmt::format("displacement_{}_cosine", c)); ++c)
    out.displacement.push_back(harmonics_of(table, fmt::format("displacement_{}", c)));
  if (out.displacement.empty()) store.fail(path("coefficients"), "has no displacement; make the file again");
  return out;
}

}  // namespace slipmode::results
