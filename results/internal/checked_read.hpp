#pragma once

// Reading with checks that every record needs.

#include <slipmode/results/store.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

/// @throws InvalidInput  when a value is NaN or infinite
[[nodiscard]] Eigen::VectorXd finite_vector(const StoreReader& store, const std::string& name,
                                            Eigen::Index size = StoreReader::kAny);
[[nodiscard]] Eigen::MatrixXd finite_columns(const StoreReader& store, const std::string& name,
                                             Eigen::Index rows = StoreReader::kAny,
                                             Eigen::Index cols = StoreReader::kAny);
[[nodiscard]] Eigen::MatrixXd finite_matrix(const StoreReader& store, const std::string& name,
                                            Eigen::Index rows = StoreReader::kAny,
                                            Eigen::Index cols = StoreReader::kAny);

/// Integers, each within [low, high]. @throws InvalidInput  naming the first that is not
[[nodiscard]] std::vector<std::int64_t> codes(const StoreReader& store, const std::string& name, Eigen::Index size,
                                              std::int64_t low, std::int64_t high);

}  // namespace slipmode::results
