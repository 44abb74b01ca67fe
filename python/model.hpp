#pragma once

#include <slipmode/pod/basis.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>
#include "python/call.hpp"
#include "python/result.hpp"

#include <memory>
#include <optional>
#include <string>

namespace slipmode::python {

/// `model`, as a study is asked for it: None or "full", the result of `reduce`, or under a shaker "BASIS:L".
class ModelChoice {
 public:
  explicit ModelChoice(Keywords& keywords);

  /// @throws InvalidInput  as studies::model_basis; may take its time: without Python's lock
  [[nodiscard]] std::optional<pod::NamedBasis> basis(const scene::Scene& scene, const studies::RunOptions& run) const;

  /// As the executable would be given it, but for the file of a reduced model.
  [[nodiscard]] std::string word() const { return reduced_ ? "rom" : word_; }

 private:
  std::string word_ = "full";
  std::shared_ptr<const results::MemoryStore> reduced_;
};

/// Of ModelChoice, for docstrings.
[[nodiscard]] std::string model_text();

}  // namespace slipmode::python
