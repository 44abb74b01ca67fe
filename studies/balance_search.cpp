#include <slipmode/studies/balance_search.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/numbers.hpp>
#include <slipmode/orbits/balance/hill.hpp>
#include <slipmode/results/balance_store.hpp>
#include <slipmode/studies/command.hpp>

#include <fmt/format.h>
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

int whole_number(const char* option, const std::string& text, const char* word) {
  const int value = number_in<int>(text).value_or(0);
  if (value < 1) throw InvalidInput(fmt::format("{} {}: valid: a whole number from 1 on, or {}", option, text, word));
  return value;
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
  const std::string harmonics = words.harmonics.value_or("9"), samples = words.samples.value_or("exact");
  if ((harmonics == "auto") != words.error.has_value()) {
    throw InvalidInput("--harmonics auto and --error, a true error > 0, go together");
  }
  if (words.error) {
    if (!(*words.error > 0.0)) throw InvalidInput(fmt::format("--error {}: valid: > 0", *words.error));
    out.error = *words.error;
  } else {
    out.options.harmonics = whole_number("--harmonics", harmonics, "auto");
  }
  if (samples != "exact") out.options.samples = whole_number("--samples", samples, "exact");
  return out;
}

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

orbits::MixedOptions mixed_options(const BalanceWords& words, const std::string& start, int period_order) {
  if (words.samples || words.error)
    throw InvalidInput("--samples, --error: of a balance; leave them out, or use --by balance");
  if (start != "settle")
    throw InvalidInput(fmt::format("--start {}: a mixed orbit begins at the linear response; leave it out", start));
  return {.order = period_order,
          .harmonics = whole_number("--harmonics", words.harmonics.value_or("9"), "leave it out"),
          .reach = words.near.value_or(0)};
}

MixedFound find_mixed(const Family& model, const orbits::MixedOptions& options, bool certify,
                      const orbits::ShootingOptions& shooting) {
  MixedFound out{.mixed = orbits::mixed_orbit(model.own(), options)};
  if (certify && out.mixed.converged) out.certificate = orbits::certify(model.own(), out.mixed, shooting);
  return out;
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
    if (search.certify) out.certificate = orbits::certify_branch(over.systems, out.branch, every.value_or(1), shooting);
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
