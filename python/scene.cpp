#include <slipmode/scene/scene.hpp>

#include <slipmode/scene/shaken.hpp>
#include "python/module.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace slipmode::python {

namespace py = pybind11;

void add_scene(py::module_& module) {
  using scene::Scene;
  py::class_<Scene>(module, "Scene", "A scene: a structure, its contacts and drive, and what is wanted of them.")
      .def_readonly("title", &Scene::title)
      .def_readonly("units", &Scene::units, "\"SI\" or \"dimensionless\"")
      .def_property_readonly("size", &Scene::size, "degrees of freedom of the full model")
      .def_property_readonly(
          "path", [](const Scene& own) { return own.source.path; }, "file it was read from")
      .def_property_readonly(
          "overrides", [](const Scene& own) { return own.source.overrides; }, "what was set beside the file")
      .def("toml", &scene::scene_to_toml, "A complete scene file that reads as the same scene, defaults written out.")
      .def("get", &scene::get_key, py::arg("key"), "Value of a numeric key, for example \"drive.speed\".")
      .def(
          "has", [](const Scene& own, const std::string& table) { return scene::has_section(own, table); },
          py::arg("table"), "True when the scene has that table (\"ensemble\", \"validation\", ...).")
      .def("__repr__", [](const Scene& own) {
        return "<slipmode.Scene '" + own.title + "', " + std::to_string(own.size()) + " degrees of freedom, " +
               std::to_string(own.contacts.size()) + " contacts>";
      });
  module.def(
      "load_scene",
      [](const std::string& path, const std::vector<std::string>& overrides) {
        return scene::load_scene(path, overrides);
      },
      py::arg("path"), py::arg("overrides"));
  module.def(
      "parse_scene",
      [](const std::string& text, const std::vector<std::string>& overrides, const std::string& path) {
        return scene::parse_scene(text, overrides, path);
      },
      py::arg("text"), py::arg("overrides"), py::arg("path"));
}

}  // namespace slipmode::python
