// Any file is either a table of columns or refused with InvalidInput.
#include <slipmode/core/errors.hpp>
#include <slipmode/results/csv_series.hpp>
#include "scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slipmode;
  try {
    const results::CsvFile file(scratch_file(".csv", data, size));
    static_cast<void>(file.time_column());
    for (std::size_t c = 0; c < file.names().size() && c < 8; ++c) {
      const Eigen::VectorXd values = file.values(c);
      if (values.size() > 0) static_cast<void>(file.line(values.size() - 1));
    }
    static_cast<void>(file.column("1"));
  } catch (const InvalidInput&) {
  }
  return 0;
}
