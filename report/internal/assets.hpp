#pragma once

#include <string_view>

namespace slipmode::report {

// Files of report/page/ and D3 with its licence, as they were when this was built (assets.cmake).
extern const std::string_view kTemplate, kStyle, kScript;
extern const std::string_view kD3, kD3Licence;  ///< empty where D3 was not installed

}  // namespace slipmode::report
