#include <slipmode/studies/balance_search.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/numbers.hpp>
#include <slipmode/orbits/balance/hill.hpp>
#include <slipmode/results/balance_store.hpp>
#include <slipmode/studies/command.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <limits>
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

int whole_number(const char* option, const std::string& text, const char* word) {
  const int value = number_in<int>(text).value_or(0);
  if (value < 1) throw InvalidInput(fmt::format("{} {}: valid: a whole number from 1 on, or {}", option, text, word));
  return value;
}

/// An order, or the error that chooses one.
struct Order {
  int harmonics = 9;
  std::optional<double> error = {};
};

Order order_of(const BalanceWords& words) {
  if ((words.harmonics == "auto") != words.error.has_value()) {
    throw InvalidInput("--harmonics auto and --error, a true error > 0, go together");
  }
  Order out{.error = words.error};
  if (words.error) {
    if (!(*words.error > 0.0)) throw InvalidInput(fmt::format("--error {}: valid: > 0", *words.error));
  } else if (words.harmonics) {
    out.harmonics = whole_number("--harmonics", *words.harmonics, "auto");
  }
  return out;
}

}  // namespace

BalanceSearch balance_search(const BalanceWords& words, const std::string& start, int period_order) {
  BalanceSearch out;
  if (words.near) throw InvalidInput(fmt::format("--near {}: of a mixed orbit; add --by mixed", *words.near));
  out.options.order = period_order;
  out.certify = words.certify;
  if (start != "settle" && start != "contact" && start != "gap") {
    throw InvalidInput(fmt::format("--start {}: a balance begins at contact (all stops pressing) or gap", start));
  }
  out.options.start = start == "gap" ? orbits::BalanceStart::kGap : orbits::BalanceStart::kContact;
  const Order order = order_of(words);
  out.error = order.error;
  out.options.harmonics = order.harmonics;
  const std::string samples = words.samples.value_or("exact");
  if (samples != "exact") out.options.samples = whole_number("--samples", samples, "exact");
  return out;
}

BalanceFound find_balance(const Family& model, const BalanceSearch& search, const orbits::ShootingOptions& shooting) {
  BalanceFound out;
  if (search.error) {
    orbits::CertifiedBalance chosen =
        orbits::balance_to_error(model.own(), search.options, *search.error, 4000, shooting);
    out = {std::move(chosen.approximation), std::move(chosen.certificate), std::move(chosen.trials), chosen.met};
  } else {
    out.balance = orbits::balance(model.own(), search.options);
    if (search.certify && out.balance.converged) out.certificate = orbits::certify(model.own(), out.balance, shooting);
  }
  add_exponents(model, out);
  return out;
}

MixedSearch mixed_search(const BalanceWords& words, const std::string& start, int period_order) {
  if (words.samples)
    throw InvalidInput(fmt::format("--samples {}: of a balance; leave it out, or use --by balance", *words.samples));
  if (start != "settle")
    throw InvalidInput(fmt::format("--start {}: a mixed orbit begins at the linear response; leave it out", start));
  const Order order = order_of(words);
  return {.options = {.order = period_order, .harmonics = order.harmonics, .reach = words.near.value_or(0)},
          .error = order.error,
          .certify = words.certify};
}

MixedFound find_mixed(const Family& model, const MixedSearch& search, const orbits::ShootingOptions& shooting) {
  constexpr int kMostHarmonics = 200;  // a Newton step takes its third power, here seconds
  if (search.error) {
    orbits::CertifiedMixed chosen =
        orbits::mixed_to_error(model.own(), search.options, *search.error, kMostHarmonics, shooting);
    return {std::move(chosen.approximation), std::move(chosen.certificate), std::move(chosen.trials), chosen.met};
  }
  MixedFound out{.mixed = orbits::mixed_orbit(model.own(), search.options)};
  if (search.certify && out.mixed.converged) out.certificate = orbits::certify(model.own(), out.mixed, shooting);
  return out;
}

std::string not_met(const std::vector<orbits::OrderTrial>& trials) {
  const orbits::OrderTrial* best = nullptr;
  for (const orbits::OrderTrial& trial : trials)
    if (trial.error >= 0.0 && (best == nullptr || trial.error <= best->error)) best = &trial;
  const std::string up_to = fmt::format("the error asked is not met up to {} harmonics: ", trials.back().harmonics);
  if (best == nullptr) return up_to + "no orbit lies behind any";
  return up_to + fmt::format("the least is {:.3g} of a half range, by {}", best->error, best->harmonics);
}

results::Content content_of(const Family& model, std::shared_ptr<const BalanceFound> found) {
  return {.kind = results::FileKind::kBalance,
          .unit_system = model.scene().units,
          .write = [model, found = std::move(found)](results::StoreWriter& writer) {
            const orbits::Certificate* certificate = found->certificate ? &*found->certificate : nullptr;
            store(writer, model, certificate != nullptr && certificate->behind ? &certificate->found.orbit : nullptr);
            results::store_balance(writer, found->balance, certificate, found->trials,
                                   results::Units::of(model.scene().units));
          }};
}

std::vector<std::string> near_names(const Family& model, const orbits::MixedOrbit& mixed) {
  std::vector<std::string> names;
  for (const Eigen::Index i : mixed.near)
    names.push_back(model.own().structure().dof_names()[static_cast<std::size_t>(i)]);
  return names;
}

results::Content content_of(const Family& model, std::shared_ptr<const MixedFound> found) {
  return {.kind = results::FileKind::kOrbit,
          .unit_system = model.scene().units,
          .write = [model, found = std::move(found)](results::StoreWriter& writer) {
            store(writer, model, &found->certificate->found.orbit);
            results::store_mixed(writer, found->mixed, near_names(model, found->mixed), *found->certificate,
                                 found->trials, results::Units::of(model.scene().units));
          }};
}

BalanceContinuation continue_balance(const scene::Scene& scene, const std::string& key,
                                     const std::optional<pod::NamedBasis>& basis, BalanceSearch search,
                                     const ContinuationRequest& request, std::optional<int> every,
                                     const orbits::ShootingOptions& shooting, const RunOptions& run) {
  constexpr int kMostHarmonics = 500;  // exponents of a point take (n H)³
  constexpr double kGrowth = 1.3;
  if (request.switches)
    throw InvalidInput("--switch: not along balances; follow the branch that leaves by shooting (--by shooting)");
  if (search.options.samples != 0)
    throw InvalidInput(
        fmt::format("--samples {}: a balance is followed by exact forces alone; leave it out", search.options.samples));
  if (every && !search.certify && !search.error)
    throw InvalidInput(fmt::format("--every {}: which points to certify; add --certify", *every));
  KeyFamily over = family_over(scene, key, basis, request, run);
  over.options.shooting = shooting;
  BalanceContinuation out{.found = find_balance(over.family, search, shooting), .start = over.start};
  const std::optional<double> error = std::exchange(search.error, std::nullopt);
  search.certify |= error.has_value();
  while (out.found.balance.converged && out.found.met) {
    const orbits::Balance& first = out.found.balance;
    out.branch = orbits::continue_balance(over.systems, first, over.start, over.options);
    if (out.branch.end == orbits::BranchEnd::kInterrupted) break;
    if (search.certify) out.certificate = orbits::certify_branch(over.systems, out.branch, every.value_or(1), shooting);
    if (!error || out.branch.end == orbits::BranchEnd::kInterrupted) break;
    out.trials.push_back(
        {first.harmonics, first.iterations,
         out.certificate->behind > 0 ? out.certificate->worst : std::numeric_limits<double>::quiet_NaN()});
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

std::string command_of(const std::string& key, const std::string& model, const OrbitSearch& search,
                       const BalanceWords& words, const std::string& start, std::optional<int> every,
                       const ContinuationRequest& request) {
  const std::string from = start == "settle" ? "" : " --start " + start;
  const std::string points = every ? fmt::format(" --every {}", *every) : "";
  return fmt::format("slipmode orbit continue --over {}={}:{}{} --by balance{}{}{}{}{}", key, request.from, request.to,
                     model_option(model), options_text(search), from, options_text(words), points,
                     options_text(request));
}

std::shared_ptr<const std::vector<results::NamedBranch>> branches_of(const BalanceContinuation& found) {
  return std::make_shared<const std::vector<results::NamedBranch>>(
      1, results::NamedBranch{.title = fmt::format("balance of {} harmonics", found.found.balance.harmonics),
                              .branch = found.branch});
}

}  // namespace slipmode::studies
