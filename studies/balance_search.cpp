#include <slipmode/studies/balance_search.hpp>

#include <utility>

namespace slipmode::studies {

BalanceFound find_balance(const Family& model, const BalanceSearch& search, const orbits::ShootingOptions& shooting) {
  if (search.error) {
    orbits::CertifiedBalance chosen =
        orbits::balance_to_error(model.own(), search.options, *search.error, 4000, shooting);
    return {std::move(chosen.balance), std::move(chosen.certificate), std::move(chosen.trials), chosen.met};
  }
  BalanceFound out{.balance = orbits::balance(model.own(), search.options)};
  if (search.certify && out.balance.converged) out.certificate = orbits::certify(model.own(), out.balance, shooting);
  return out;
}

}  // namespace slipmode::studies
