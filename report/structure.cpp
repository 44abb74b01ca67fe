#include "report/internal/structure.hpp"

#include <slipmode/fem/beam.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>

namespace slipmode::report {
namespace {

constexpr int kMostPoints = 24;

/// Numbers of masses, from 1, at contacts.
std::vector<int> masses_at(const scene::ContactPlace& place) {
  if (const int* mass = std::get_if<int>(&place)) return {*mass};
  if (const auto* between = std::get_if<scene::Between>(&place)) return {between->first, between->second};
  return {};
}

DrawnStructure drawn_masses(const scene::Scene& scene) {
  const auto n = static_cast<int>(scene.size());
  std::set<int> shown;
  for (int k = 0; k < std::min(n, kMostPoints); ++k)
    shown.insert(n <= kMostPoints ? k + 1
                                  : 1 + static_cast<int>(static_cast<std::int64_t>(k) * (n - 1) / (kMostPoints - 1)));
  Json contacts = Json::array();
  for (const scene::ContactSpec& contact : scene.contacts) {
    const std::vector<int> masses = masses_at(contact.at);
    shown.insert(masses.begin(), masses.end());
    contacts.push_back({{"name", contact.name}, {"x", masses.empty() ? Json(nullptr) : Json(masses.back())}});
  }
  DrawnStructure out{.about = {}, .readings = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(shown.size()), n)};
  Eigen::Index row = 0;
  for (const int mass : shown) out.readings(row++, mass - 1) = 1.0;
  const fem::ChainOptions* chain = scene.chain();
  out.about = {{"kind", chain != nullptr                                               ? "chain"
                        : std::holds_alternative<scene::MatricesSpec>(scene.structure) ? "matrices"
                                                                                       : "masses"},
               {"x", shown},
               {"size", n},
               {"fixed", {chain != nullptr && chain->left_fixed, chain != nullptr && chain->right_fixed}},
               {"contacts", contacts}};
  return out;
}

DrawnStructure drawn_beam(const scene::Scene& scene) {
  const fem::Beam beam = scene::build_beam(scene);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(kMostPoints, 0.0, beam.reach());
  DrawnStructure out{.about = {}, .readings = Eigen::MatrixXd(kMostPoints, beam.structure().size())};
  for (Eigen::Index k = 0; k < kMostPoints; ++k) out.readings.row(k) = beam.displacement_row(x[k]).transpose();
  Json contacts = Json::array();
  for (const scene::ContactSpec& contact : scene.contacts) {
    const double* place = std::get_if<double>(&contact.at);
    contacts.push_back({{"name", contact.name}, {"x", number_json(place != nullptr ? *place : beam.reach())}});
  }
  out.about = {{"kind", "beam"}, {"x", list_json(x)}, {"fixed", {true, false}}, {"contacts", contacts}};
  return out;
}

}  // namespace

DrawnStructure drawn_structure(const scene::Scene& scene) {
  return scene.beam() != nullptr ? drawn_beam(scene) : drawn_masses(scene);
}

Json shapes_json(const Eigen::MatrixXd& shapes) {
  const double low = shapes.minCoeff(), high = shapes.maxCoeff(), step = high > low ? (high - low) / 250.0 : 1.0;
  Json rows = Json::array();
  for (const auto& row : shapes.rowwise()) rows.push_back(stepped_json(row.transpose(), low, step));
  return rows;
}

Json contact_modes_json(const std::vector<dynamics::Event>& events, const std::vector<dynamics::ContactMode>& modes,
                        double start) {
  Json out = Json::array();
  for (std::size_t c = 0; c < modes.size(); ++c) {
    auto first = modes[c];
    Json later = Json::array();
    bool known = false;
    for (const dynamics::Event& event : events) {
      if (event.contact != static_cast<int>(c)) continue;
      const bool before = event.time <= start;
      if (before || !known) first = before ? event.after : event.before;
      known = true;
      if (!before) later.push_back({number_json(event.time - start), static_cast<int>(event.after)});
    }
    later.insert(later.begin(), Json{0.0, static_cast<int>(first)});
    out.push_back(std::move(later));
  }
  return out;
}

}  // namespace slipmode::report
