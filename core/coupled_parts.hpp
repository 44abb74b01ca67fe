#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace slipmode {

/// Indices, ascending.
using Part = std::vector<Eigen::Index>;

/// The parts of a square matrix that no entry other than zero couples, by their first index. What is solved part by
/// part keeps exact zeros between them: a decomposition of the whole would leave its rounding there.
[[nodiscard]] std::vector<Part> coupled_parts(const Eigen::MatrixXd& A);

/// Values and one column for each.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
/// The spectra of a matrix's parts as one, ascending. @param solve  of one part, with vectors in its indices
[[nodiscard]] Spectrum spectrum_by_parts(const std::vector<Part>& parts,
                                         const std::function<Spectrum(const Part&)>& solve);

}  // namespace slipmode
