// Any file is either a result file or refused with InvalidInput, whatever is asked of it.
#include "core/errors.hpp"
#include "scene/info.hpp"
#include "scene/provenance.hpp"
#include "scene/records.hpp"
#include "scratch_file.hpp"

namespace {

template <class Read>
void refused_or_read(const Read& read) {
  try {
    read();
  } catch (const slipmode::InvalidInput&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slipmode::scene;
  const std::string path = scratch_file(".h5", data, size);
  refused_or_read([&] { static_cast<void>(info(path, InfoFormat::kText)); });
  refused_or_read([&] {
    const StoreReader store(path);
    refused_or_read([&] { static_cast<void>(load_provenance(store)); });
    refused_or_read([&] { static_cast<void>(load_trajectory(store)); });
    refused_or_read([&] { static_cast<void>(load_ensemble(store)); });
    refused_or_read([&] { static_cast<void>(load_pod(store)); });
    refused_or_read([&] { static_cast<void>(load_reduced(store)); });
  });
  return 0;
}
