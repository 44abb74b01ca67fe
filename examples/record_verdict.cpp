// What is a record: periodic, chaotic, noise? Here of a map whose exponent is known.
#include <slipmode/diagnostics/series/series_study.hpp>

#include <cmath>
#include <cstdio>

int main() {
  using namespace slipmode;
  diagnostics::Series record{.values = Eigen::VectorXd(5000), .name = "Henon map"};
  double x = 0.1, y = 0.1;
  for (Eigen::Index k = -100; k < record.values.size(); ++k) {
    const double next = 1.0 - 1.4 * x * x + y;
    y = 0.3 * x;
    x = next;
    if (k >= 0) record.values(k) = x;
  }

  const diagnostics::SeriesStudy study = diagnostics::study_series(
      record, {.tools = {diagnostics::SeriesTool::kVerdict, diagnostics::SeriesTool::kJacobians}});
  const Eigen::VectorXd& exponents = study.jacobians->exponents;
  std::printf("%s: %s\nlargest exponent %.4f nat per step\n", to_string(study.verdict->motion),
              study.verdict->reason.c_str(), exponents(0));

  // 0.4192 nat per step: J. C. Sprott, Chaos and Time-Series Analysis, 2003, appendix A.
  return study.verdict->motion == diagnostics::SeriesMotion::kChaotic && std::abs(exponents(0) - 0.4192) < 0.02 ? 0 : 1;
}
