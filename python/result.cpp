#include "python/result.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/results/provenance.hpp>
#include "python/module.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace slipmode::python {

namespace py = pybind11;

namespace {

using results::Dataset;
using results::StoreEntry;

/// A view that keeps alive what owns the numbers. Not to be written to: other results may share them.
template <class T>
py::object array_of(const Dataset& dataset, const std::shared_ptr<const T>& values) {
  if (dataset.shape.empty()) return py::cast(*values);
  const py::capsule owner(new std::shared_ptr<const T>(values),
                          [](void* kept) { delete static_cast<std::shared_ptr<const T>*>(kept); });
  py::array_t<T> view(std::vector<py::ssize_t>(dataset.shape.begin(), dataset.shape.end()), values.get(), owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

py::object value_of(const Dataset& dataset) {
  switch (dataset.kind) {
    case StoreEntry::Kind::kDouble:
      return array_of(dataset, dataset.numbers);
    case StoreEntry::Kind::kInteger:
      return array_of(dataset, dataset.integers);
    case StoreEntry::Kind::kText:
      if (dataset.shape.empty()) return py::cast(dataset.texts.front());
      return py::cast(dataset.texts);
    default:
      return py::none();
  }
}

const Dataset& dataset_of(const Result& own, const std::string& name) {
  const Dataset* dataset = own.store()->find(name);
  if (dataset == nullptr) throw py::key_error(name);
  return *dataset;
}

}  // namespace

void add_result(py::module_& module) {
  py::class_<Result>(module, "Store", "What a result file holds, in memory.")
      .def_property_readonly("kind", [](const Result& own) { return own.store()->kind(); })
      .def("names",
           [](const Result& own) {
             std::vector<std::string> names;
             for (const Dataset& dataset : own.store()->datasets()) {
               if (dataset.kind != StoreEntry::Kind::kGroup) names.push_back(dataset.name);
             }
             return names;
           })
      .def("value", [](const Result& own, const std::string& name) { return value_of(dataset_of(own, name)); })
      .def("meaning",
           [](const Result& own, const std::string& name) {
             const Dataset* dataset = own.store()->find(name);
             if (dataset == nullptr) return std::pair<std::string, std::string>();
             return std::pair(dataset->meaning.units, dataset->meaning.description);
           })
      .def(
          "save", [](const Result& own, const std::string& path) { own.store()->save(path); },
          py::call_guard<py::gil_scoped_release>())
      .def("scene", [](const Result& own) { return results::load_scene_of(own.reader()); });
  module.def(
      "read",
      [](const std::string& path) {
        return Result(std::make_shared<const results::MemoryStore>(results::StoreReader(path)));
      },
      py::call_guard<py::gil_scoped_release>());
}

}  // namespace slipmode::python
