#include <slipmode/scene/scene.hpp>

#include <slipmode/scene/driven.hpp>
#include "python/call.hpp"
#include "python/module.hpp"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <variant>

namespace slipmode::python {

namespace py = pybind11;

namespace {

/// The fields of a table under its heading.
template <class S>
std::string table_text(const std::string& heading) {
  std::string text = fmt::format("\n{}\n", heading);
  for_each_field<S>([&](const auto& field) {
    text += fmt::format("    {}: {}{}\n", field.name, meaning_text(field), field.is_required ? ", required" : "");
  });
  return text;
}

template <std::size_t... law>
std::string law_texts(std::index_sequence<law...>) {
  const std::vector<std::string> words = friction::law_words();
  return (
      table_text<std::variant_alternative_t<law, friction::Law>>(fmt::format("[[contact]] law = \"{}\"", words[law])) +
      ...);
}

/// The keys of a scene, from the field lists that read them.
std::string scene_text() {
  constexpr std::size_t kWithWords = std::variant_size_v<friction::Law> - 1;  // the last is a function of C++
  return "A scene: a structure, its contacts and drive, and what is wanted of them. Its tables and their keys; those\n"
         "with more than one form are in datasets/README.md.\n" +
         table_text<fem::ChainOptions>("[structure] kind = \"chain\"") +
         table_text<fem::BeamSpan>("[structure] kind = \"beam\", or [[structure.span]]") +
         table_text<fem::MassesOptions>("[structure] kind = \"masses\"") +
         law_texts(std::make_index_sequence<kWithWords>()) + table_text<scene::TimeSpec>("[time]") +
         table_text<scene::TimeSpec::Cycles>("[time] in cycles of a shaker or a force") +
         table_text<scene::InitialSpec>("[initial]") + table_text<scene::EnsembleSpec>("[ensemble]") +
         table_text<scene::SensorSpec>("[sensors]") + table_text<scene::ReductionSpec>("[reduction]") +
         table_text<scene::ValidationSpec>("[validation] under a belt") +
         table_text<scene::DrivenValidationSpec>("[validation] under a shaker or a force");
}

}  // namespace

void add_scene(py::module_& module) {
  using scene::Scene;
  py::class_<Scene>(module, "Scene", scene_text().c_str())
      .def_readonly("title", &Scene::title)
      .def_readonly("units", &Scene::units, "\"SI\" or \"dimensionless\"")
      .def_property_readonly("size", &Scene::size, "degrees of freedom of the full model")
      .def_property_readonly(
          "path", [](const Scene& own) { return own.source.path; }, "file it was read from")
      .def_property_readonly(
          "overrides", [](const Scene& own) { return own.source.overrides; }, "what was set beside the file")
      .def_property_readonly(
          "text", [](const Scene& own) { return own.source.text; }, "what was read")
      .def("toml", &scene::scene_file,
           "A scene file of the same scene, overrides and defaults of its tables written out; times left to its\n"
           "periods stay so.")
      .def("get", &scene::get_key, py::arg("key"), "Value of a numeric key, for example \"drive.speed\".")
      .def(
          "has", [](const Scene& own, const std::string& table) { return scene::has_section(own, table); },
          py::arg("table"), "True when the scene has that table (\"ensemble\", \"validation\", ...).")
      .def(py::pickle(
          [](const Scene& own) { return py::make_tuple(own.source.text, own.source.overrides, own.source.path); },
          [](const py::tuple& kept) {
            return scene::parse_scene(kept[0].cast<std::string>(), kept[1].cast<std::vector<std::string>>(),
                                      kept[2].cast<std::string>());
          }))
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
