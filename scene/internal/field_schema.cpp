#include "scene/internal/field_schema.hpp"

#include <utility>

namespace slipmode::scene {

Json number_schema(const Limits& limits, const char* type) {
  Json schema = {{"type", type}};
  if (limits.low != kFinite.low) schema[limits.above ? "exclusiveMinimum" : "minimum"] = limits.low;
  if (limits.high != kFinite.high) schema["maximum"] = limits.high;
  return schema;
}

Json array_schema(Json items, std::size_t least, std::optional<std::size_t> most) {
  Json schema = {{"type", "array"}, {"items", std::move(items)}};
  if (least > 0) schema["minItems"] = least;
  if (most) schema["maxItems"] = *most;
  return schema;
}

Json any_of(const std::vector<Json>& schemas) { return {{"anyOf", schemas}}; }

TableSchema& TableSchema::key(const std::string& name, Json schema, const std::string& meaning) {
  properties_[name] = {{"description", meaning}};
  properties_[name].update(schema);
  return *this;
}

TableSchema& TableSchema::word(const std::string& name, const std::string& word, const std::string& meaning) {
  return key(name, {{"const", word}}, meaning).require(name);
}

TableSchema& TableSchema::require(const std::string& name) {
  required_.push_back(name);
  return *this;
}

TableSchema& TableSchema::one_of(const std::vector<std::string>& names) {
  Json group = Json::array();
  for (const std::string& name : names) group.push_back({{"required", {name}}});
  all_of_.push_back({{"oneOf", group}});
  return *this;
}

TableSchema& TableSchema::otherwise(const std::string& name, const std::string& text) {
  Json& own = properties_[name];
  own.erase("default");
  own["description"] = fmt::format("{}; default: {}", own["description"].get<std::string>(), text);
  return *this;
}

Json TableSchema::json() const {
  Json schema = {{"type", "object"}, {"properties", properties_}, {"additionalProperties", false}};
  if (!required_.empty()) schema["required"] = required_;
  if (!all_of_.empty()) schema["allOf"] = all_of_;
  return schema;
}

}  // namespace slipmode::scene
