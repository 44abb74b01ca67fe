#include <slipmode/core/errors.hpp>
#include <slipmode/core/signs.hpp>
#include <slipmode/pod/gram_schmidt.hpp>
#include <slipmode/pod/pod.hpp>
#include "pod/internal/centred.hpp"
#include "pod/internal/mass_metric.hpp"

namespace slipmode::pod {

PodResult mass_pod(const Ensemble& ensemble, const fem::Matrix& M, const PodOptions& options) {
  validate(ensemble);
  const MassMetric metric(M, ensemble.snapshots.rows(), "POD in the mass metric");
  PodResult result = pod({metric.whiten(ensemble.snapshots), ensemble.run_begin}, options);
  result.basis.vectors = metric.unwhiten(result.basis.vectors);
  check_mass_orthonormal(result.basis.vectors, M, "POD in the mass metric");
  fix_signs(result.basis.vectors);
  result.basis.mean = Centred(ensemble.snapshots, options.remove_mean).mean();
  result.basis.kind = BasisKind::kMassPom;
  result.basis.provenance += ", in the mass metric";
  return result;
}

}  // namespace slipmode::pod
