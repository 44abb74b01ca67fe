// Any text is either a scene or refused with InvalidInput; a scene written and read again is the same scene, and small
// ones build or are refused.
#include <slipmode/core/errors.hpp>
#include <slipmode/scene/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>

namespace {

using namespace slipmode;

std::optional<scene::Scene> parsed(const std::string& text) {
  try {
    return scene::parse_scene(text);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

void build(const scene::Scene& scene) {
  constexpr Eigen::Index kSmall = 24;
  if (scene.size() > kSmall) return;
  try {
    const dynamics::HybridSystem system = scene::build_system(scene);
    static_cast<void>(scene::initial_state(scene, system));
    static_cast<void>(scene::simulate_options(scene));
  } catch (const InvalidInput&) {
  } catch (const NumericalFailure&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::optional<scene::Scene> scene = parsed({reinterpret_cast<const char*>(data), size});
  if (!scene) return 0;
  const std::string written = scene::scene_to_toml(*scene);
  const std::optional<scene::Scene> again = parsed(written);
  if (!again || scene::scene_to_toml(*again) != written) std::abort();
  build(*scene);
  return 0;
}
