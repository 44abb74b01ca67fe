#pragma once

#include <string>

namespace slipmode::cli {

/// What `slipmode diagnose` is asked whatever INPUT is.
struct DiagnoseRequest {
  std::string input;    ///< FILE[:SERIES], or a scene (.toml)
  std::string output;   ///< HDF5 file; empty: none
  std::string figures;  ///< folder for all figures; empty: none
  bool bits = true;     ///< exponents in bits rather than nats
};

}  // namespace slipmode::cli
