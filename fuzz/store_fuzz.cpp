// Whatever a valid HDF5 file holds, it is a result of ours or refused with InvalidInput. The input says which datasets
// of a real result are left out, or replaced by others of other types, shapes and values. (Bytes that are not HDF5's
// are libhdf5's own affair.)
#include <slipmode/results/info.hpp>
#include "results/internal/hdf5_handle.hpp"
#include "results/internal/seal.hpp"
#include "scratch_file.hpp"
#include "store_input.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace {

using slipmode::results::Hdf5Handle;

struct Seed {
  std::vector<std::uint8_t> bytes;
  std::vector<std::string> datasets;
};

herr_t note_dataset(hid_t, const char* name, const H5O_info_t* info, void* out_names) {
  if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(out_names)->emplace_back(name);
  return 0;
}

std::vector<Seed> read_seeds() {
  std::vector<Seed> seeds;
  for (const char* name : kSeeds) {
    const std::string path = std::string("store_seeds/") + name;
    std::ifstream in(path, std::ios::binary);
    Seed seed;
    seed.bytes.assign(std::istreambuf_iterator<char>(in), {});
    std::fill_n(seed.bytes.begin(), slipmode::results::kSealBytes, 0);  // a seal would refuse whatever is changed
    const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!file.valid()) std::abort();
    H5Ovisit(file.id(), H5_INDEX_NAME, H5_ITER_NATIVE, note_dataset, &seed.datasets);
    seeds.push_back(std::move(seed));
  }
  return seeds;
}

/// Puts a dataset in place of the one of that name.
void replace(hid_t file, const std::string& name, const Replacement& input) {
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  if (input.kind == Replacement::Kind::kNone) return;
  const std::array<hid_t, 4> kinds = {H5T_NATIVE_DOUBLE, H5T_NATIVE_INT64, H5T_NATIVE_UINT8, H5T_C_S1};
  const hid_t kind = kinds[static_cast<std::size_t>(input.kind)];
  const std::vector<hsize_t> dims(input.extents.begin(), input.extents.begin() + input.rank);
  const Hdf5Handle space(input.rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(input.rank, dims.data(), nullptr),
                         H5Sclose);
  const Hdf5Handle dataset(H5Dcreate2(file, name.c_str(), kind, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                           H5Dclose);
  if (dataset.valid() && input.count > 0)
    H5Dwrite(dataset.id(), kind, H5S_ALL, H5S_ALL, H5P_DEFAULT, input.values.data());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slipmode::results;
  const QuietHdf5 quiet;
  // The cache of an open file is half a megabyte: given back and taken again, that is most of an input's time.
  static const herr_t kept = H5set_free_list_limits(-1, -1, -1, -1, -1, -1);
  static_cast<void>(kept);
  static const std::vector<Seed> seeds = read_seeds();
  Input input(data, size);
  const Seed& seed = seeds[input.byte() % seeds.size()];
  const std::string path = scratch_file(".h5", seed.bytes.data(), seed.bytes.size());
  {
    const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    for (int changes = 0; changes < 8 && !input.empty(); ++changes) {
      const std::string& name = seed.datasets[input.byte() % seed.datasets.size()];
      replace(file.id(), name, Replacement(input));
    }
  }
  refused_or_read([&] { static_cast<void>(info(path, InfoFormat::kText)); });
  refused_or_read([&] { read_all(StoreReader(path)); });
  return 0;
}
