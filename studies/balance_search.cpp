#include <slipmode/studies/balance_search.hpp>

#include <slipmode/orbits/balance/hill.hpp>

#include <algorithm>
#include <utility>

namespace slipmode::studies {
namespace {

void add_exponents(const Family& model, BalanceFound& out_found) {
  const orbits::Balance& balance = out_found.balance;
  if (!balance.converged || orbits::has_memory(model.own()) || model.own().size() * balance.harmonics > kMostForHill)
    return;
  out_found.hill = orbits::hill_multipliers(model.own(), balance);
  out_found.hill_without_jumps = orbits::hill_multipliers(model.own(), balance, {.jumps = false});
}

}  // namespace

BalanceFound find_balance(const Family& model, const BalanceSearch& search, const orbits::ShootingOptions& shooting) {
  BalanceFound out;
  if (search.error) {
    orbits::CertifiedBalance chosen =
        orbits::balance_to_error(model.own(), search.options, *search.error, 4000, shooting);
    out = {std::move(chosen.balance), std::move(chosen.certificate), std::move(chosen.trials), chosen.met};
  } else {
    out.balance = orbits::balance(model.own(), search.options);
    if (search.certify && out.balance.converged) out.certificate = orbits::certify(model.own(), out.balance, shooting);
  }
  add_exponents(model, out);
  return out;
}

BalanceContinuation continue_balance(const scene::Scene& scene, const std::string& key,
                                     const std::optional<pod::NamedBasis>& basis, BalanceSearch search,
                                     const ContinuationRequest& request, int every,
                                     const orbits::ShootingOptions& shooting, const RunOptions& run) {
  constexpr int kMostHarmonics = 500;  // exponents of a point take (n H)³
  constexpr double kGrowth = 1.3;
  KeyFamily over = family_over(scene, key, basis, request, run);
  over.options.shooting = shooting;
  BalanceContinuation out{.found = find_balance(over.family, search, shooting), .start = over.start};
  const std::optional<double> error = std::exchange(search.error, std::nullopt);
  search.certify |= error.has_value();
  while (out.found.balance.converged && out.found.met) {
    const orbits::Balance& first = out.found.balance;
    out.branch = orbits::continue_balance(over.systems, first, over.start, over.options);
    if (search.certify) out.certificate = orbits::certify_branch(over.systems, out.branch, every, shooting);
    if (!error) break;
    out.trials.push_back({first.harmonics, first.iterations, out.certificate->worst});
    if (out.certificate->behind > 0 && out.certificate->worst <= *error) break;
    search.options.harmonics = std::max(first.harmonics + 1, static_cast<int>(kGrowth * first.harmonics));
    search.options.guess = first.displacement;
    BalanceFound next;
    if (search.options.harmonics <= kMostHarmonics) next = find_balance(over.family, search, shooting);
    out.found.met = next.balance.converged;  // else what was found is kept
    if (out.found.met) out.found = std::move(next);
  }
  return out;
}

}  // namespace slipmode::studies
