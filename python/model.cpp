#include "python/model.hpp"

#include <slipmode/results/reduced_file.hpp>
#include <slipmode/studies/bases.hpp>

namespace slipmode::python {

ModelChoice::ModelChoice(Keywords& keywords) {
  const py::object given = keywords.take("model");
  if (!given) return;
  if (py::isinstance<Result>(given)) {
    reduced_ = given.cast<const Result&>().store();
  } else if (py::isinstance<py::str>(given)) {
    word_ = given.cast<std::string>();
  } else {
    keywords.refuse("model", given, "\"full\", a result of reduce, or under a shaker \"BASIS:L\", e.g. \"pomf:3\"");
  }
}

std::optional<pod::NamedBasis> ModelChoice::basis(const scene::Scene& scene, const studies::RunOptions& run) const {
  if (!reduced_) return studies::model_basis(scene, word_, run);
  return pod::NamedBasis{.name = "", .basis = results::reduced_basis(results::StoreReader(reduced_), scene.size())};
}

std::string model_text() {
  return "    model (str | Result): \"full\", a result of `reduce`, or under a shaker \"BASIS:L\", e.g. \"pomf:3\"\n"
         "        (default \"full\")\n";
}

}  // namespace slipmode::python
