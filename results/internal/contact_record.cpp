#include "results/internal/contact_record.hpp"

#include <slipmode/core/none.hpp>
#include <slipmode/core/overloaded.hpp>
#include <slipmode/scene/scene_words.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <array>
#include <cmath>

namespace slipmode::results {

namespace {

/// The numbers of all laws; NaN where a law has none.
struct LawNumbers {
  double mu_s = kNone, mu_k = kNone, alpha = kNone, epsilon = kNone;
  double stiffness = kNone, stribeck_speed = kNone, damping = kNone, viscous = kNone;
};

LawNumbers numbers_of(const friction::Law& law) {
  LawNumbers n{.mu_s = friction::static_coefficient(law), .mu_k = friction::limit_coefficient(law)};
  std::visit(Overloaded{[](const friction::Coulomb&) {}, [&n](const friction::Stribeck& own) { n.alpha = own.alpha; },
                        [&n](const friction::TanhRegularised& own) {
                          n.alpha = own.alpha;
                          n.epsilon = own.epsilon;
                        },
                        [&n](const friction::CompliantCoulomb& own) { n.stiffness = own.stiffness; },
                        [&n](const friction::Dahl& own) { n.stiffness = own.stiffness; },
                        [&n](const friction::LuGre& own) {
                          n.stribeck_speed = own.stribeck_speed;
                          n.stiffness = own.stiffness;
                          n.damping = own.damping;
                          n.viscous = own.viscous;
                        },
                        [](const friction::Clearance&) {}},
             law);
  return n;
}

constexpr Eigen::Index kStopNumbers = 3;

Eigen::VectorXd stop_numbers(const std::optional<friction::Stop>& stop) {
  if (!stop) return Eigen::VectorXd::Constant(kStopNumbers, kNone);
  return Eigen::VectorXd{{stop->stiffness, stop->damping, stop->gap}};
}

std::optional<friction::Stop> stop_of(const Eigen::VectorXd& own) {
  if (std::isnan(own(0))) return std::nullopt;
  return friction::Stop{own(0), own(1), own(2)};
}

/// Both stops of a contact, left first; all NaN for another law.
Eigen::VectorXd stops_numbers(const friction::Law& law) {
  const auto* clearance = std::get_if<friction::Clearance>(&law);
  Eigen::VectorXd both(2 * kStopNumbers);
  both << stop_numbers(clearance != nullptr ? clearance->left : std::nullopt),
      stop_numbers(clearance != nullptr ? clearance->right : std::nullopt);
  return both;
}

std::string loss_word(const friction::Law& law) {
  const auto* clearance = std::get_if<friction::Clearance>(&law);
  return clearance != nullptr ? scene::kLosses[static_cast<std::size_t>(clearance->loss)] : std::string();
}

friction::Law clearance_of(const Eigen::VectorXd& stops, const std::string& loss) {
  const bool gap = loss == scene::kLosses[static_cast<std::size_t>(friction::ContactLoss::kGap)];
  return friction::Clearance{stop_of(stops.head(kStopNumbers)), stop_of(stops.tail(kStopNumbers)),
                             gap ? friction::ContactLoss::kGap : friction::ContactLoss::kZeroForce};
}

/// The law of that word made of those numbers.
friction::Law law_of(const std::string& word, const LawNumbers& n, const StoreReader& store, const std::string& name) {
  if (word == "coulomb") return friction::Coulomb{n.mu_s, n.mu_k};
  if (word == "stribeck") return friction::Stribeck{n.mu_s, n.mu_k, n.alpha};
  if (word == "tanh") return friction::TanhRegularised{n.mu_s, n.mu_k, n.alpha, n.epsilon};
  if (word == "compliant") return friction::CompliantCoulomb{n.mu_s, n.mu_k, n.stiffness};
  if (word == "dahl") return friction::Dahl{n.mu_s, n.stiffness};
  if (word == "lugre") return friction::LuGre{n.mu_s, n.mu_k, n.stribeck_speed, n.stiffness, n.damping, n.viscous};
  store.fail(name, fmt::format("'{}'; expected {}", word, fmt::join(scene::kLaws, ", ")));
}

/// A dataset with one number per contact.
struct LawColumn {
  const char* name;
  Meaning meaning;
  double LawNumbers::*number;
};

const std::array<LawColumn, 8>& law_columns() {
  static const std::array<LawColumn, 8> kColumns = {
      {{"mu_s", {"1", "static coefficient"}, &LawNumbers::mu_s},
       {"mu_k", {"1", "kinetic coefficient"}, &LawNumbers::mu_k},
       {"alpha", {"s/m", "decay with sliding speed; NaN where the law has none"}, &LawNumbers::alpha},
       {"epsilon", {"m/s", "regularisation speed; NaN where the law has none"}, &LawNumbers::epsilon},
       {"stiffness", {"N/m", "of contact spring or bristle; NaN where the law has none"}, &LawNumbers::stiffness},
       {"stribeck_speed", {"m/s", "Stribeck speed; NaN where the law has none"}, &LawNumbers::stribeck_speed},
       {"bristle_damping", {"N s/m", "of the bristle; NaN where the law has none"}, &LawNumbers::damping},
       {"viscous", {"N s/m", "viscous friction; NaN where the law has none"}, &LawNumbers::viscous}}};
  return kColumns;
}

constexpr Eigen::Index kOscillatorNumbers = 6;

Eigen::VectorXd oscillator_numbers(const friction::NormalLoad& load) {
  if (!load.oscillator) return Eigen::VectorXd::Constant(kOscillatorNumbers, kNone);
  const friction::NormalOscillator& own = *load.oscillator;
  return Eigen::VectorXd{
      {own.mass, own.support_stiffness, own.support_damping, own.spring_stiffness, own.spring_damping, own.slope}};
}

friction::NormalLoad load_of(double constant, double slope, const Eigen::VectorXd& own) {
  if (std::isnan(own(0))) return {constant, slope};
  return {constant, friction::NormalOscillator{own(0), own(1), own(2), own(3), own(4), own(5)}};
}

/// One number per contact; `otherwise` in files of versions that did not have it.
Eigen::VectorXd numbers_or(const StoreReader& store, const std::string& name, Eigen::Index count, double otherwise) {
  return store.has(name) ? store.vector(name, count) : Eigen::VectorXd::Constant(count, otherwise);
}

}  // namespace

void save_contacts(StoreWriter& store, const std::string& group, const std::vector<friction::Contact>& contacts,
                   Eigen::Index n) {
  const auto count = static_cast<Eigen::Index>(contacts.size());
  std::vector<std::string> names, laws, losses;
  Eigen::VectorXd load(count), slope(count), tilt(count), offset(count);
  Eigen::MatrixXd oscillator(kOscillatorNumbers, count), stops(2 * kStopNumbers, count), direction(n, count);
  std::vector<LawNumbers> numbers;
  for (Eigen::Index c = 0; c < count; ++c) {
    const friction::Contact& contact = contacts[static_cast<std::size_t>(c)];
    names.push_back(contact.name);
    laws.push_back(scene::kLaws[contact.law.index()]);
    numbers.push_back(numbers_of(contact.law));
    load(c) = contact.normal_load.constant;
    slope(c) = contact.normal_load.slope;
    oscillator.col(c) = oscillator_numbers(contact.normal_load);
    stops.col(c) = stops_numbers(contact.law);
    losses.push_back(loss_word(contact.law));
    tilt(c) = contact.tilt;
    offset(c) = contact.offset;
    direction.col(c) = contact.direction;
  }
  store.describe_group(group, "contacts, one entry of each dataset per contact");
  store.write(group + "/name", names, {"", "name"});
  store.write(group + "/law", laws, {"", fmt::format("{}", fmt::join(scene::kLaws, ", "))});
  for (const LawColumn& column : law_columns()) {
    std::vector<double> values;
    for (const LawNumbers& own : numbers) values.push_back(own.*column.number);
    store.write(group + "/" + column.name, values, column.meaning);
  }
  store.write(group + "/normal_load", load, {"N", "normal load, constant part"});
  store.write(group + "/normal_load_slope", slope, {"N/m", "normal load per contact displacement"});
  store.write_columns(group + "/oscillator", oscillator,
                      {"",
                       "normal oscillator, contact x (mass [kg], support stiffness [N/m] and damping [N s/m], "
                       "spring stiffness and damping, slope); NaN: none"});
  store.write_columns(
      group + "/stops", stops,
      {"",
       "stops of a clearance, contact x (left stiffness [N/m], damping [N s/m] and gap [m], the same of "
       "the right one); NaN: none"});
  store.write(group + "/loss", losses, {"", fmt::format("when a stop lets go: {}", fmt::join(scene::kLosses, ", "))});
  store.write(group + "/tilt", tilt, {"rad", "of the slider's face"});
  store.write(group + "/offset", offset, {"m", "added to the contact displacement"});
  store.write_columns(group + "/direction", direction, {"1", "contact directions w, contact x dof"});
}

std::vector<friction::Contact> load_contacts(const StoreReader& store, const std::string& group, Eigen::Index n) {
  const std::vector<std::string> names = store.texts(group + "/name");
  const auto count = static_cast<Eigen::Index>(names.size());
  const std::vector<std::string> laws = store.texts(group + "/law", count);
  std::vector<LawNumbers> numbers(names.size());
  for (const LawColumn& column : law_columns()) {
    const Eigen::VectorXd values = numbers_or(store, group + "/" + column.name, count, kNone);
    for (std::size_t c = 0; c < numbers.size(); ++c) {
      numbers[c].*column.number = values(static_cast<Eigen::Index>(c));
    }
  }
  const Eigen::VectorXd load = store.vector(group + "/normal_load", count);
  const Eigen::VectorXd slope = numbers_or(store, group + "/normal_load_slope", count, 0.0);
  const Eigen::MatrixXd oscillator = store.has(group + "/oscillator")
                                         ? store.columns(group + "/oscillator", kOscillatorNumbers, count)
                                         : Eigen::MatrixXd::Constant(kOscillatorNumbers, count, kNone);
  const bool stopped = store.has(group + "/stops");  // not in files of versions that had no clearance
  const Eigen::MatrixXd stops = stopped ? store.columns(group + "/stops", 2 * kStopNumbers, count)
                                        : Eigen::MatrixXd::Constant(2 * kStopNumbers, count, kNone);
  const std::vector<std::string> losses =
      stopped ? store.texts(group + "/loss", count) : std::vector<std::string>(names.size());
  const Eigen::VectorXd tilt = numbers_or(store, group + "/tilt", count, 0.0);
  const Eigen::VectorXd offset = store.vector(group + "/offset", count);
  const Eigen::MatrixXd direction = store.columns(group + "/direction", n, count);
  std::vector<friction::Contact> contacts;
  for (Eigen::Index c = 0; c < count; ++c) {
    const auto at = static_cast<std::size_t>(c);
    contacts.push_back({.direction = direction.col(c),
                        .law = laws[at] == "clearance" ? clearance_of(stops.col(c), losses[at])
                                                       : law_of(laws[at], numbers[at], store, group + "/law"),
                        .normal_load = load_of(load(c), slope(c), oscillator.col(c)),
                        .offset = offset(c),
                        .tilt = tilt(c),
                        .name = names[at]});
  }
  return contacts;
}

}  // namespace slipmode::results
