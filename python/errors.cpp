#include "python/errors.hpp"

#include <slipmode/core/parallel.hpp>
#include "python/module.hpp"

#include <pybind11/eigen.h>

#include <utility>

namespace slipmode::python {

namespace py = pybind11;

namespace {

/// Lives as long as the interpreter.
PyObject* numerical_failure = nullptr;

void set(const NumericalFailure& failure, const py::object& result) {
  const py::object error = py::reinterpret_borrow<py::object>(numerical_failure)(failure.what());
  error.attr("time") = failure.time;
  error.attr("state") = failure.state;
  error.attr("residual") = failure.residual;
  error.attr("result") = result;
  PyErr_SetObject(numerical_failure, error.ptr());
}

}  // namespace

void raise(const NumericalFailure& failure, const py::object& result) {
  set(failure, result);
  throw py::error_already_set();
}

void add_errors(py::module_& module) {
  py::register_exception<InvalidInput>(module, "InvalidInput", PyExc_ValueError).attr("__doc__") =
      "Something the user can mend: a value, a key, a file. Says what was expected, what was found, and where.";
  numerical_failure = PyErr_NewExceptionWithDoc(
      "slipmode.NumericalFailure",
      "A computation that could not be completed: `time` and `state` where it happened, `residual` what should have\n"
      "been zero (NaN: there is none), `result` what was finished before (or None).",
      PyExc_RuntimeError, nullptr);
  module.add_object("NumericalFailure", py::reinterpret_borrow<py::object>(numerical_failure));
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      std::rethrow_exception(std::move(error));
    } catch (const NumericalFailure& failure) {
      set(failure, py::none());
    } catch (const Interrupted&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
  });
}

}  // namespace slipmode::python
