#include "results/internal/checked_read.hpp"

#include <fmt/format.h>

namespace slipmode::results {

namespace {

template <class Values>
Values finite(const StoreReader& store, const std::string& name, Values values) {
  if (!values.allFinite()) {
    store.fail(name, "holds NaN or an infinity; expected finite numbers, make the file again");
  }
  return values;
}

}  // namespace

Eigen::VectorXd finite_vector(const StoreReader& store, const std::string& name, Eigen::Index size) {
  return finite(store, name, store.vector(name, size));
}

Eigen::MatrixXd finite_columns(const StoreReader& store, const std::string& name, Eigen::Index rows,
                               Eigen::Index cols) {
  return finite(store, name, store.columns(name, rows, cols));
}

Eigen::MatrixXd finite_matrix(const StoreReader& store, const std::string& name, Eigen::Index rows, Eigen::Index cols) {
  return finite(store, name, store.matrix(name, rows, cols));
}

std::vector<std::int64_t> codes(const StoreReader& store, const std::string& name, Eigen::Index size, std::int64_t low,
                                std::int64_t high) {
  std::vector<std::int64_t> values = store.integers(name, size);
  for (const std::int64_t value : values) {
    if (value < low || value > high) {
      store.fail(name, fmt::format("holds {}; expected {} to {}", value, low, high));
    }
  }
  return values;
}

}  // namespace slipmode::results
