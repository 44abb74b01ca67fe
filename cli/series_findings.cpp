#include "cli/series_findings.hpp"

#include "cli/json_values.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {
std::string findings_text(const std::vector<diagnostics::Finding>& findings) {
  std::vector<std::vector<std::string>> rows;
  std::size_t widths[3] = {0, 0, 0};
  for (const diagnostics::Finding& finding : findings) {
    rows.push_back({finding.quantity, diagnostics::with_error(finding.value, finding.error),
                    finding.unit == "1" ? "" : finding.unit, finding.settings});
    for (std::size_t k = 0; k < 3; ++k) widths[k] = std::max(widths[k], shown_width(rows.back()[k]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line = "  ";
    for (std::size_t k = 0; k < 3; ++k) line += row[k] + std::string(widths[k] - shown_width(row[k]) + 2, ' ');
    line += row[3];
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

Json findings_json(const std::vector<diagnostics::Finding>& findings) {
  Json out = Json::object();
  for (const diagnostics::Finding& finding : findings) out[finding.key] = fields_json(finding);
  return out;
}

}  // namespace slipmode::cli
