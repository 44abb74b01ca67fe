#pragma once

#include <slipmode/dynamics/modal_model.hpp>
#include <slipmode/dynamics/regime.hpp>
#include <slipmode/dynamics/step_tables.hpp>
#include <slipmode/dynamics/system.hpp>

#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace slipmode::dynamics {

/// A modal model with the tables that grow on it.
struct ModelTables {
  explicit ModelTables(ModalModel m) : model(std::move(m)), steps(model) {}
  const ModalModel model;
  const StepTables steps;
};

/// Modal models of a structure and the directions of its contacts and forces, with and without mode shapes, each built
/// when first asked for. Laws and drive do not enter.
class ModelCache {
 public:
  /// @param rows_only  contact rows without mode shapes, where the structure allows it
  [[nodiscard]] const ModelTables& tables(const HybridSystem& system, bool rows_only);

 private:
  std::mutex building_;
  std::unique_ptr<ModelTables> full_, rows_;
};

/// What a HybridSystem and its copies under other drives share; the models also under other laws.
class SystemCache {
 public:
  explicit SystemCache(std::shared_ptr<ModelCache> models = std::make_shared<ModelCache>())
      : models_(std::move(models)) {}

  [[nodiscard]] const std::shared_ptr<ModelCache>& models() const { return models_; }
  [[nodiscard]] const ModelTables& tables(const HybridSystem& system, bool rows_only) {
    return models_->tables(system, rows_only);
  }
  /// The regime in which contacts have these roles, built when first visited.
  [[nodiscard]] const RegimeTables& regime(const HybridSystem& system, const std::vector<ContactRole>& roles);

 private:
  std::shared_ptr<ModelCache> models_;
  std::mutex building_;
  std::map<std::vector<ContactRole>, std::unique_ptr<RegimeTables>> regimes_;
};

}  // namespace slipmode::dynamics
