#include "results/internal/contact_record.hpp"

#include <slipmode/core/none.hpp>
#include "results/internal/field_record.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <map>

namespace slipmode::results {

namespace {

const std::vector<std::string> kLosses(kWords<friction::ContactLoss>.begin(), kWords<friction::ContactLoss>.end());

/// Calls visit(field) for the number of any law that is kept in each dataset, in the order in which laws first have it.
template <class Visit>
void for_each_column(const Visit& visit) {
  std::vector<std::string> seen;
  for (std::size_t kind = 0; kind < std::variant_size_v<friction::Law>; ++kind) {
    std::visit(
        [&]<class Law>(const Law&) {
          for_each_number<Law>([&](const auto& field) {
            if (std::ranges::find(seen, field.stored) != seen.end()) return;
            seen.emplace_back(field.stored);
            visit(field);
          });
        },
        alternative<friction::Law>(kind));
  }
}

/// The number of a law kept in a dataset; NaN where it has none. Every law has coefficients.
double law_number(const friction::Law& any, const std::string& dataset) {
  if (dataset == "mu_s") return friction::static_coefficient(any);
  if (dataset == "mu_k") return friction::limit_coefficient(any);
  double number = kNone;
  std::visit(
      [&]<class Law>(const Law& law) {
        for_each_number<Law>([&](const auto& field) {
          if (dataset == field.stored) number = law.*field.member;
        });
      },
      any);
  return number;
}

/// The numbers of a struct that may be absent: then all NaN.
template <class S>
Eigen::VectorXd numbers_or_none(const std::optional<S>& own) {
  return own ? to_numbers(*own) : Eigen::VectorXd::Constant(kNumbers<S>, kNone);
}

template <class S>
std::optional<S> if_numbers(const Eigen::VectorXd& numbers) {
  return std::isnan(numbers(0)) ? std::nullopt : std::optional(from_numbers<S>(numbers));
}

constexpr Eigen::Index kStopNumbers = kNumbers<friction::Stop>;
constexpr Eigen::Index kOscillatorNumbers = kNumbers<friction::NormalOscillator>;

/// Both stops of a contact, left first; all NaN for another law.
Eigen::VectorXd stops_numbers(const friction::Clearance& clearance) {
  Eigen::VectorXd both(2 * kStopNumbers);
  both << numbers_or_none(clearance.left), numbers_or_none(clearance.right);
  return both;
}

/// The law of that word with contact c's numbers.
friction::Law law_of(const StoreReader& store, const std::string& name, const std::string& word,
                     const std::map<std::string, Eigen::VectorXd>& numbers, Eigen::Index c) {
  const std::vector<std::string> words = friction::law_words();
  const auto found = std::ranges::find(words, word);
  if (found == words.end()) store.fail(name, fmt::format("'{}'; expected {}", word, fmt::join(words, ", ")));
  auto any = alternative<friction::Law>(static_cast<std::size_t>(found - words.begin()));
  std::visit(
      [&]<class Law>(Law& law) {
        for_each_number<Law>([&](const auto& field) { law.*field.member = numbers.at(field.stored)(c); });
      },
      any);
  return any;
}

/// The points of the laws that are made of points, which other laws pay nothing for.
void save_points(StoreWriter& store, const std::string& name, const std::vector<friction::Contact>& contacts) {
  std::vector<double> owner, speed, coefficient;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const auto* law = std::get_if<friction::Measured>(&contacts[c].law);
    if (law == nullptr) continue;
    owner.insert(owner.end(), law->speeds.size(), static_cast<double>(c));
    speed.insert(speed.end(), law->speeds.begin(), law->speeds.end());
    coefficient.insert(coefficient.end(), law->coefficients.begin(), law->coefficients.end());
  }
  if (owner.empty()) return;
  save(store, name,
       Table{.description = "points of friction characteristics",
             .columns = {{"contact", {"", "index of the contact"}, owner},
                         {"speed", {"m/s", "sliding speed"}, speed},
                         {"coefficient", {"1", "friction coefficient there"}, coefficient}}});
}

void load_points(const StoreReader& store, const std::string& name, std::vector<friction::Contact>& contacts) {
  const auto is_measured = [](const auto& contact) { return std::holds_alternative<friction::Measured>(contact.law); };
  if (std::ranges::none_of(contacts, is_measured)) return;
  const Table table = load_table(store, name);
  for (std::size_t k = 0; k < table.rows(); ++k) {
    const double owner = table.numbers("contact")[k];
    if (!(owner >= 0.0 && owner < static_cast<double>(contacts.size()))) {
      store.fail(name, fmt::format("contact {} of {}", owner, contacts.size()));
    }
    auto* law = std::get_if<friction::Measured>(&contacts[static_cast<std::size_t>(owner)].law);
    if (law == nullptr) store.fail(name, fmt::format("contact {} has no law made of points", owner));
    law->speeds.push_back(table.numbers("speed")[k]);
    law->coefficients.push_back(table.numbers("coefficient")[k]);
  }
}

}  // namespace

void save_contacts(StoreWriter& store, const std::string& group, const std::vector<friction::Contact>& contacts,
                   Eigen::Index n) {
  const auto count = static_cast<Eigen::Index>(contacts.size());
  std::vector<std::string> names, laws, losses;
  std::vector<friction::NormalLoad> loads;
  Eigen::MatrixXd oscillator(kOscillatorNumbers, count), stops(2 * kStopNumbers, count), direction(n, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const friction::Contact& contact = contacts[static_cast<std::size_t>(c)];
    const friction::Clearance* clearance = friction::clearance(contact.law);
    names.push_back(contact.name);
    laws.push_back(friction::law_word(contact.law));
    loads.push_back(contact.normal_load);
    oscillator.col(c) = numbers_or_none(contact.normal_load.oscillator);
    stops.col(c) = stops_numbers(clearance != nullptr ? *clearance : friction::Clearance{});
    losses.push_back(clearance != nullptr ? kLosses[static_cast<std::size_t>(clearance->loss)] : "");
    direction.col(c) = contact.direction;
  }
  store.describe_group(group, "contacts, one entry of each dataset per contact");
  store.write(group + "/name", names, {"", "name"});
  store.write(group + "/law", laws, {"", fmt::format("{}", fmt::join(friction::law_words(), ", "))});
  for_each_column([&](const auto& field) {
    const std::string name = field.stored;
    std::vector<double> values;
    for (const friction::Contact& contact : contacts) values.push_back(law_number(contact.law, name));
    const char* gaps = name.starts_with("mu_") ? "" : "; NaN where the law has none";
    store.write(group + "/" + name, values, {field.unit, std::string(field.meaning) + gaps});
  });
  save_rows(store, group, loads);
  store.write_columns(group + "/oscillator", oscillator,
                      {"",
                       "normal oscillator, contact x (mass [kg], support stiffness [N/m] and damping [N s/m], "
                       "spring stiffness and damping, slope); NaN: none"});
  store.write_columns(
      group + "/stops", stops,
      {"",
       "stops of a clearance, contact x (left stiffness [N/m], damping [N s/m] and gap [m], the same of "
       "the right one); NaN: none"});
  store.write(group + "/loss", losses, {"", fmt::format("when a stop lets go: {}", fmt::join(kLosses, ", "))});
  save_points(store, group + "/points", contacts);
  save_rows(store, group, contacts);
  store.write_columns(group + "/direction", direction, {"1", "contact directions w, contact x dof"});
}

std::vector<friction::Contact> load_contacts(const StoreReader& store, const std::string& group, Eigen::Index n) {
  const std::vector<std::string> names = store.texts(group + "/name");
  const auto count = static_cast<Eigen::Index>(names.size());
  const std::vector<std::string> laws = store.texts(group + "/law", count);
  std::map<std::string, Eigen::VectorXd> numbers;
  for_each_column([&](const auto& field) {  // not in files of versions that did not have it
    const std::string name = group + "/" + field.stored;
    numbers[field.stored] = store.has(name) ? store.vector(name, count) : Eigen::VectorXd::Constant(count, kNone);
  });
  const auto loads = load_rows<friction::NormalLoad>(store, group, count);
  const Eigen::MatrixXd oscillator = store.has(group + "/oscillator")
                                         ? store.columns(group + "/oscillator", kOscillatorNumbers, count)
                                         : Eigen::MatrixXd::Constant(kOscillatorNumbers, count, kNone);
  const bool stopped = store.has(group + "/stops");  // not in files of versions that had no clearance
  const Eigen::MatrixXd stops = stopped ? store.columns(group + "/stops", 2 * kStopNumbers, count)
                                        : Eigen::MatrixXd::Constant(2 * kStopNumbers, count, kNone);
  const std::vector<std::string> losses =
      stopped ? store.texts(group + "/loss", count) : std::vector<std::string>(names.size());
  const Eigen::MatrixXd direction = store.columns(group + "/direction", n, count);
  auto contacts = load_rows<friction::Contact>(store, group, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const auto at = static_cast<std::size_t>(c);
    friction::Contact& contact = contacts[at];
    contact.direction = direction.col(c);
    contact.law = law_of(store, group + "/law", laws[at], numbers, c);
    contact.normal_load = loads[at];
    contact.normal_load.oscillator = if_numbers<friction::NormalOscillator>(oscillator.col(c));
    contact.name = names[at];
    if (auto* clearance = std::get_if<friction::Clearance>(&contact.law)) {
      clearance->left = if_numbers<friction::Stop>(stops.col(c).head(kStopNumbers));
      clearance->right = if_numbers<friction::Stop>(stops.col(c).tail(kStopNumbers));
      if (losses[at] == kLosses.back()) clearance->loss = friction::ContactLoss::kGap;
    }
  }
  load_points(store, group + "/points", contacts);
  return contacts;
}

}  // namespace slipmode::results
