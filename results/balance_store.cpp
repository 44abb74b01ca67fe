#include <slipmode/results/balance_store.hpp>

#include <slipmode/core/to_vector.hpp>
#include "results/internal/field_record.hpp"

#include <fmt/format.h>

namespace slipmode::results {
namespace {

std::string path(const char* name) { return fmt::format("{}/{}", kBalanceGroup, name); }

}  // namespace

void store_balance(StoreWriter& store, const orbits::Balance& balance, const orbits::Certificate* certificate,
                   const std::vector<orbits::OrderTrial>& trials, const Units& units) {
  Table table{.description = "y = sum over orders k of cosine cos(k omega t) + sine sin(k omega t)", .columns = {}};
  std::vector<double> orders;
  for (int k = 0; k <= balance.harmonics; ++k) orders.push_back(k);
  table.columns.push_back({"order", {"", "k"}, orders});
  for (std::size_t c = 0; c < balance.displacement.size(); ++c) {
    const auto add = [&](const char* word, const std::string& unit, const orbits::Harmonics& own) {
      const std::string name = fmt::format("{}_{}", word, c + 1), what = fmt::format("{} of contact {}", word, c + 1);
      table.columns.push_back({name + "_cosine", {unit, what + ", cosines"}, values_of(own.cosine)});
      table.columns.push_back({name + "_sine", {unit, what + ", sines"}, values_of(own.sine)});
    };
    add("displacement", units.length, balance.displacement[c]);
    add("force", units.force, balance.force[c]);
  }
  store.describe_group(kBalanceGroup, "a truncated Fourier series that balances the equations of motion");
  save_fields(store, kBalanceGroup, balance);
  save(store, path("coefficients"), table);
  save(store, path("trials"), Table{"orders tried, and their true errors", columns_of(trials)});
  if (certificate == nullptr) return;
  store.write(path("verdict"), certificate->verdict, {"", "what shooting from it says"});
  store.write(path("error"), certificate->error, {units.length, "sup |y - exact| over the period, per contact"});
}

StoredBalance load_balance(const StoreReader& store) {
  StoredBalance out{
      .omega = store.number(path("omega")), .displacement = {}, .trials = load_table(store, path("trials"))};
  const Table table = load_table(store, path("coefficients"));
  for (std::size_t c = 1; table.has(fmt::format("displacement_{}_cosine", c)); ++c)
    out.displacement.push_back({to_vector(table.numbers(fmt::format("displacement_{}_cosine", c))),
                                to_vector(table.numbers(fmt::format("displacement_{}_sine", c)))});
  if (out.displacement.empty()) store.fail(path("coefficients"), "has no displacement; make the file again");
  return out;
}

}  // namespace slipmode::results
