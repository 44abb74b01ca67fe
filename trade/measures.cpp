#include <slipmode/trade/measures.hpp>

namespace slipmode::trade {

namespace {

struct Words {
  std::string_view name, description;
};

constexpr std::array<Words, kMeasures> kWords = {
    {{"dX", "deviation of the motion from shared starts, up to the horizon"},
     {"dE", "deviation of the mean energy from shared starts, up to the horizon"},
     {"points", "distance of slip states or section points (Wasserstein-1), of the reading's rms"},
     {"spread", "distance of the reading's values at all times (Wasserstein-1), of its rms"},
     {"energy", "mean energy of the settled motion"},
     {"stick", "share of the time in stick, percentage points"}}};

}  // namespace

std::string_view to_string(Measure measure) { return kWords[static_cast<std::size_t>(measure)].name; }

std::string_view to_string(Question question) { return question == Question::kMotion ? "motion" : "statistics"; }

std::string_view describe(Measure measure) { return kWords[static_cast<std::size_t>(measure)].description; }

}  // namespace slipmode::trade
