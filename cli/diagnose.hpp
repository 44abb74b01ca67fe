#pragma once

#include "cli/session.hpp"

#include <string>

namespace slipmode::cli {

/// What `slipmode diagnose` is asked whatever INPUT is.
struct DiagnoseRequest {
  std::string input;    ///< FILE[:SERIES], or a scene (.toml)
  std::string output;   ///< HDF5 file; empty: none
  std::string figures;  ///< folder for all figures; empty: none
  bool bits = true;     ///< exponents in bits rather than nats
};

/// The file that holds all, from which figures are drawn: the one asked for, or one in their folder; empty: neither.
[[nodiscard]] std::string diagnosis_file(const DiagnoseRequest& request);
/// @throws InvalidInput  where file or figures cannot be made, before any work is done
void check_diagnosis_outputs(const DiagnoseRequest& request);
/// The figures of a file, where they are wanted, and where they are.
void draw_diagnosis(const DiagnoseRequest& request, const std::string& file, Report& out_report);

}  // namespace slipmode::cli
