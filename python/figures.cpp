#include <slipmode/figures/file_figures.hpp>
#include <slipmode/figures/style.hpp>
#include "python/module.hpp"
#include "python/result.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slipmode::python {

namespace py = pybind11;
using namespace py::literals;
using figures::Drawing;

namespace {

py::dict series_of(const figures::Series& own) {
  return py::dict("title"_a = own.title, "look"_a = word_of(own.look), "colour"_a = std::string(own.colour),
                  "x"_a = own.x, "y"_a = own.y, "error"_a = own.error);
}

py::object field_of(const std::optional<figures::ColourField>& own) {
  if (!own) return py::none();
  return py::dict("x"_a = own->x, "y"_a = own->y, "value"_a = own->value, "label"_a = own->label, "low"_a = own->low,
                  "high"_a = own->high, "words"_a = own->words, "missing"_a = own->missing);
}

py::dict panel_of(const Drawing::Axes& own) {
  py::list series;
  for (const figures::Series& one : own.series) series.append(series_of(one));
  return py::dict("title"_a = own.title, "series"_a = series, "x_label"_a = own.x_label, "y_label"_a = own.y_label,
                  "log_x"_a = own.log_x, "log_y"_a = own.log_y, "shaded"_a = own.shaded,
                  "field"_a = field_of(own.field));
}

py::dict figure_of(const figures::FileFigure& figure, const Drawing& own) {
  py::list panels;
  for (const Drawing::Axes& axes : own.panels) panels.append(panel_of(axes));
  return py::dict("name"_a = figure.name, "what"_a = figure.what, "panels"_a = panels, "columns"_a = own.columns,
                  "shared_x"_a = word_of(own.x), "shared_y"_a = word_of(own.y),
                  "shade"_a = std::string(figures::kStickShade));
}

/// What each figure that tells shows, the most telling first. @param most  so many at most
py::list figures_of(const Result& result, std::size_t most) {
  std::vector<std::pair<figures::FileFigure, Drawing>> drawn;
  {
    const py::gil_scoped_release unlocked;
    const results::StoreReader reader = result.reader();
    for (const figures::FileFigure& figure : figures::figures_of(reader)) {
      if (drawn.size() == most) break;
      Drawing drawing = figure.draw(reader).drawing();
      if (!drawing.panels.empty()) drawn.emplace_back(figure, std::move(drawing));
    }
  }
  py::list out;
  for (const auto& [figure, drawing] : drawn) out.append(figure_of(figure, drawing));
  return out;
}

}  // namespace

void add_figures(py::module_& module) {
  module.def("figures", &figures_of, py::arg("result"), py::arg("most") = std::numeric_limits<std::size_t>::max());
}

}  // namespace slipmode::python
