#pragma once

#include <slipmode/core/errors.hpp>

#include <pybind11/pybind11.h>

namespace slipmode::python {

/// Raises slipmode.NumericalFailure with time, state, residual and, where a part was finished, `result`.
[[noreturn]] void raise(const NumericalFailure& failure, const pybind11::object& result = pybind11::none());

}  // namespace slipmode::python
