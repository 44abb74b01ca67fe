// Whatever a valid HDF5 file holds, it is a result of ours or refused with InvalidInput. The input says which datasets
// of a real result are left out, or replaced by others of other types, shapes and values. (Bytes that are not HDF5's
// are libhdf5's own affair.)
#include <slipmode/core/errors.hpp>
#include <slipmode/results/info.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include "results/internal/hdf5_handle.hpp"
#include "results/internal/seal.hpp"
#include "scratch_file.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
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

/// Results in the folder store_seeds, where scripts/fuzz.sh puts them.
std::vector<Seed> read_seeds() {
  std::vector<Seed> seeds;
  for (const char* name : {"run.h5", "pod.h5", "reduced.h5"}) {
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

/// Numbers out of an input, zeros once it is used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : next_(data), left_(size) {}
  [[nodiscard]] bool empty() const { return left_ == 0; }
  [[nodiscard]] unsigned byte() {
    if (left_ == 0) return 0;
    --left_;
    return *next_++;
  }
  void fill(void* out, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) static_cast<std::uint8_t*>(out)[i] = static_cast<std::uint8_t>(byte());
  }

 private:
  const std::uint8_t* next_;
  std::size_t left_;
};

/// Puts a dataset of up to three dimensions of up to seven in place of the one of that name.
void replace(hid_t file, const std::string& name, Input& input) {
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const std::array<hid_t, 4> kinds = {H5T_NATIVE_DOUBLE, H5T_NATIVE_INT64, H5T_NATIVE_UINT8, H5T_C_S1};
  const unsigned kind = input.byte() % 5;
  if (kind == 4) return;  // left out
  std::array<hsize_t, 3> dims{};
  const int rank = static_cast<int>(input.byte() % 4);
  std::size_t count = 1;
  for (int d = 0; d < rank; ++d) {
    dims[static_cast<std::size_t>(d)] = input.byte() % 8;
    count *= dims[static_cast<std::size_t>(d)];
  }
  std::array<double, 343> values{};
  input.fill(values.data(), count * sizeof(double));
  const Hdf5Handle space(rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, dims.data(), nullptr), H5Sclose);
  const Hdf5Handle dataset(
      H5Dcreate2(file, name.c_str(), kinds[kind], space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  if (dataset.valid() && count > 0) H5Dwrite(dataset.id(), kinds[kind], H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

template <class Read>
void refused_or_read(const Read& read) {
  try {
    read();
  } catch (const slipmode::InvalidInput&) {
  }
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
    for (int changes = 0; changes < 8 && !input.empty(); ++changes)
      replace(file.id(), seed.datasets[input.byte() % seed.datasets.size()], input);
  }
  refused_or_read([&] { static_cast<void>(info(path, InfoFormat::kText)); });
  refused_or_read([&] {
    const StoreReader store(path);
    static_cast<void>(kind_of(store));
    refused_or_read([&] { static_cast<void>(load_provenance(store)); });
    refused_or_read([&] { static_cast<void>(load_trajectory(store)); });
    refused_or_read([&] { static_cast<void>(load_pod(store)); });
    refused_or_read([&] { static_cast<void>(load_reduced(store)); });
  });
  return 0;
}
