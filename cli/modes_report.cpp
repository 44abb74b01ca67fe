#include "cli/modes_report.hpp"

#include <slipmode/core/to_vector.hpp>
#include <slipmode/results/table.hpp>
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {
namespace {

constexpr Eigen::Index kShownModes = 6;

Json rows_of(const Eigen::MatrixXd& table) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < table.rows(); ++i) {
    const Eigen::VectorXd row = table.row(i);
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return rows;
}

std::string share_table(const std::string& name, const Eigen::MatrixXd& shares) {
  std::vector<std::string> header = {name};
  for (Eigen::Index k = 0; k < shares.cols(); ++k) header.push_back(fmt::format("LNM {}", k + 1));
  TextTable table(header);
  for (Eigen::Index i = 0; i < shares.rows(); ++i) {
    std::vector<std::string> row = {fmt::format("{}", i + 1)};
    for (Eigen::Index k = 0; k < shares.cols(); ++k) row.push_back(fixed(100.0 * shares(i, k), 2));
    table.add(std::move(row));
  }
  return table.str();
}

}  // namespace

std::string text_of(const results::ShakenModes& modes) {
  const auto line = [](const std::string& what, const Eigen::VectorXd& shares) {
    std::string out = what + ":";
    for (Eigen::Index i = 0; i < std::min(kShownModes, shares.size()); ++i) {
      out += fmt::format(" {:.4f}", 100.0 * shares[i]);
    }
    return out + " %\n";
  };
  std::string out = line("energy of POMs of all degrees of freedom, mass metric", modes.mass_pom.shares);
  if (modes.pomf) {
    out += line("energy of POMs at the sensors", modes.pomf->discrete.shares);
    out += line("energy of POMFs", modes.pomf->mass_shares);
    out += fmt::format("share of linear natural modes in each POMF [%]\n{}", share_table("POMF", modes.pomf_shares));
  }
  return out + fmt::format("share of linear natural modes in each POM of the mass metric [%]\n{}",
                           share_table("mass POM", modes.mass_shares));
}

Json json_of(const results::ShakenModes& modes) {
  Json out = {{"mass_pom",
               {{"shares", results::values_of(modes.mass_pom.shares)}, {"lnm_shares", rows_of(modes.mass_shares)}}}};
  if (!modes.pomf) return out;
  out["pomf"] = {{"sensor_shares", results::values_of(modes.pomf->discrete.shares)},
                 {"mass_shares", results::values_of(modes.pomf->mass_shares)},
                 {"lnm_shares", rows_of(modes.pomf_shares)},
                 {"condition", modes.pomf->condition}};
  return out;
}

}  // namespace slipmode::cli
