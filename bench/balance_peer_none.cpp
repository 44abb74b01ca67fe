// Where FFTW is missing.
#include "bench/balance_peer.hpp"

namespace slipmode::bench {

std::unique_ptr<AlternatingScheme> alternating_scheme(int /*harmonics*/, int /*samples*/) { return nullptr; }

}  // namespace slipmode::bench
