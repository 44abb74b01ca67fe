#include <slipmode/core/errors.hpp>
#include <slipmode/results/store.hpp>
#include "results/internal/hdf5_handle.hpp"
#include "results/internal/seal.hpp"
#include "results/internal/store_ends.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>

namespace slipmode::results {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kChunkedFrom = 64 * 1024;  // bytes; smaller datasets are stored in one piece
constexpr std::size_t kChunkBytes = 512 * 1024;  // fits HDF5's default chunk cache of 1 MiB
constexpr unsigned kDeflateLevel = 1;
constexpr std::size_t kTrialBytes = 64 * 1024;
constexpr double kWorthwhile =
    0.75;  // motions keep 0.95 of their bytes, and deflating them takes ten times their integration

fs::path temporary_beside(const fs::path& path) {
  const auto ticks = std::chrono::steady_clock::now().time_since_epoch().count();
  return path.parent_path() / fmt::format(".{}.{}-{:x}.tmp", path.filename().string(), ::getpid(), ticks);
}

/// Whether the middle of the data is worth deflating, shuffled as HDF5 does it: byte k of all numbers side by side.
bool shrinks(const void* data, std::size_t count, std::size_t element) {
  const std::size_t taken = std::min(count, kTrialBytes / element);
  const auto* const bytes = static_cast<const Bytef*>(data) + (count - taken) / 2 * element;
  std::vector<Bytef> shuffled(taken * element);
  for (std::size_t k = 0; k < element; ++k)
    for (std::size_t i = 0; i < taken; ++i) shuffled[k * taken + i] = bytes[i * element + k];
  uLongf size = compressBound(shuffled.size());
  std::vector<Bytef> deflated(size);
  return compress2(deflated.data(), &size, shuffled.data(), shuffled.size(), kDeflateLevel) == Z_OK &&
         static_cast<double>(size) < kWorthwhile * static_cast<double>(shuffled.size());
}

/// Largest chunk of at most kChunkBytes made of whole rows, or of parts of one row.
std::vector<hsize_t> chunk_shape(const std::vector<hsize_t>& shape, std::size_t element) {
  std::vector<hsize_t> chunk = shape;
  hsize_t room = std::max<hsize_t>(1, kChunkBytes / element);
  for (std::size_t d = shape.size(); d-- > 0;) {
    chunk[d] = std::clamp<hsize_t>(room, 1, shape[d]);
    room = std::max<hsize_t>(1, room / chunk[d]);
  }
  return chunk;
}

Hdf5Handle text_type(std::size_t length) {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), std::max<std::size_t>(1, length));
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  return type;
}

/// "N s/m" and its like: made of metres, kilograms, seconds.
bool has_dimension(const std::string& units) {
  constexpr std::array<std::string_view, 6> kUnits = {"m", "kg", "s", "N", "J", "Hz"};
  constexpr const char* kBetween = " /,^-";
  for (std::size_t begin = 0; begin < units.size();) {
    const std::size_t end = std::min(units.find_first_of(kBetween, begin), units.size());
    if (std::ranges::find(kUnits, std::string_view(units).substr(begin, end - begin)) != kUnits.end()) return true;
    begin = end + 1;
  }
  return false;
}

/// A file under a temporary name.
class Hdf5Target final : public StoreTarget {
 public:
  explicit Hdf5Target(fs::path target) : StoreTarget(std::move(target)) {
    require_writable(path());
    temporary_ = temporary_beside(path());
    const QuietHdf5 quiet;
    const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_userblock(creation.id(), kSealBytes);
    file_ = Hdf5Handle(H5Fcreate(temporary_.c_str(), H5F_ACC_EXCL, creation.id(), H5P_DEFAULT), H5Fclose);
    if (!file_.valid()) {
      const int cause = errno;
      std::error_code ignored;
      fs::remove(temporary_, ignored);  // made, but not even its first bytes written
      throw InvalidInput(
          fmt::format("{}: cannot be written ({}); check the folder's permissions or choose another output",
                      path().string(), std::strerror(cause)));
    }
  }

  ~Hdf5Target() override {
    const QuietHdf5 quiet;
    file_.reset();
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove(temporary_, ignored);
  }

  void say(const FileKindWords& words) const {
    const QuietHdf5 quiet;
    const Hdf5Handle root(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose);
    attribute(root.id(), "kind", words.word);
    attribute(root.id(), "description", words.meaning);
  }

  void write(const std::string& name, const Shape& shape, const double* values, const Meaning& meaning) override {
    dataset(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, shape, values, meaning);
  }

  void write(const std::string& name, const Shape& shape, const std::int64_t* values, const Meaning& meaning) override {
    dataset(name, H5T_STD_I64LE, H5T_NATIVE_INT64, shape, values, meaning);
  }

  void write(const std::string& name, const Shape& shape, std::span<const std::string> values,
             const Meaning& meaning) override {
    std::size_t width = 1;
    for (const std::string& value : values) width = std::max(width, value.size());
    std::string padded(width * values.size(), '\0');
    for (std::size_t i = 0; i < values.size(); ++i)
      std::ranges::copy(values[i], padded.begin() + std::ptrdiff_t(i * width));
    const Hdf5Handle type = text_type(width);
    dataset(name, type.id(), type.id(), shape, padded.data(), meaning);
  }

  void describe_group(const std::string& name, const std::string& description) override {
    const QuietHdf5 quiet;
    check_open(name);
    Hdf5Handle group(H5Gopen2(file_.id(), name.c_str(), H5P_DEFAULT), H5Gclose);
    if (!group.valid()) {
      const Hdf5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
      H5Pset_create_intermediate_group(links.id(), 1);
      group = Hdf5Handle(H5Gcreate2(file_.id(), name.c_str(), links.id(), H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    }
    if (!group.valid()) fail(name, "group could not be made; is there a dataset of this name already?");
    attribute(group.id(), "description", description);
  }

  void commit() override {
    const QuietHdf5 quiet;
    check_open("commit");
    if (!file_.reset() || !seal(temporary_)) fail("commit", "could not be finished; is the disc full?");
    const int descriptor = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
    const bool synced = descriptor >= 0 && ::fsync(descriptor) == 0;
    if (descriptor >= 0) ::close(descriptor);
    if (!synced) fail("commit", fmt::format("could not be synced: {}", std::strerror(errno)));
    std::error_code error;
    fs::rename(temporary_, path(), error);
    if (error) fail("commit", fmt::format("could not be renamed into place: {}", error.message()));
    temporary_.clear();
  }

 private:
  void check_open(const std::string& name) const {
    if (failed_) fail(name, "an earlier write to this file failed");
    if (!file_.valid()) fail(name, "the file is already committed; write everything before commit");
  }

  void attribute(hid_t object, const char* key, const std::string& value) const {
    const Hdf5Handle type = text_type(value.size());
    const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Handle attr(H5Acreate2(object, key, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (!attr.valid() || H5Awrite(attr.id(), type.id(), value.empty() ? "" : value.data()) < 0) {
      fail(key, "attribute could not be written; is the disc full?");
    }
  }

  /// The one place where a dataset is made. An empty shape is a scalar.
  void dataset(const std::string& name, hid_t file_type, hid_t memory_type, const Shape& extents, const void* data,
               const Meaning& meaning) {
    const QuietHdf5 quiet;
    check_open(name);
    const std::vector<hsize_t> shape(extents.begin(), extents.end());
    const Hdf5Handle space(
        shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
        H5Sclose);
    std::size_t count = 1;
    for (const hsize_t extent : shape) count *= extent;

    const Hdf5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links.id(), 1);
    const Hdf5Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(layout.id(), false);  // the same content gives the same bytes
    const std::size_t element = H5Tget_size(file_type);
    if (!shape.empty() && count * element >= kChunkedFrom) {
      const std::vector<hsize_t> chunk = chunk_shape(shape, element);
      H5Pset_chunk(layout.id(), static_cast<int>(chunk.size()), chunk.data());
      if (H5Tget_size(memory_type) == element && shrinks(data, count, element)) {
        H5Pset_shuffle(layout.id());
        H5Pset_deflate(layout.id(), kDeflateLevel);
      }
      H5Pset_fletcher32(layout.id());
    }

    const Hdf5Handle set(
        H5Dcreate2(file_.id(), name.c_str(), file_type, space.id(), links.id(), layout.id(), H5P_DEFAULT), H5Dclose);
    if (!set.valid()) fail(name, "dataset could not be made; is there one of this name already, or is the disc full?");
    if (count > 0 && H5Dwrite(set.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
      failed_ = true;
      fail(name, "could not be written; is the disc full?");
    }
    attribute(set.id(), "units", meaning.units);
    attribute(set.id(), "description", meaning.description);
  }

  fs::path temporary_;
  Hdf5Handle file_;
  bool failed_ = false;
};

}  // namespace

void require_writable(const fs::path& file) {
  if (file.filename().empty() || fs::is_directory(file)) {
    throw InvalidInput(fmt::format("{}: is a folder; expected the name of a file", file.string()));
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder)) {
    throw InvalidInput(fmt::format("{}: the folder {} does not exist; create it (mkdir -p) or choose another output",
                                   file.string(), folder.string()));
  }
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw InvalidInput(fmt::format("{}: cannot be written (folder {}: {}); choose another output", file.string(),
                                   folder.string(), std::strerror(errno)));
  }
}

void StoreTarget::fail(const std::string& name, const std::string& what) const {
  throw InvalidInput(fmt::format("{}: {}: {}", path_.string(), name, what));
}

StoreWriter::StoreWriter(fs::path path, FileKind kind, const std::string& unit_system)
    : dimensionless_(unit_system != "SI") {
  auto target = std::make_unique<Hdf5Target>(std::move(path));
  target->say(words_of(kind));
  target_ = std::move(target);
}
StoreWriter::StoreWriter(MemoryStore& store, const std::string& unit_system)
    : target_(memory_target(store)), dimensionless_(unit_system != "SI") {}
StoreWriter::~StoreWriter() = default;
StoreWriter::StoreWriter(StoreWriter&&) noexcept = default;
StoreWriter& StoreWriter::operator=(StoreWriter&&) noexcept = default;

Meaning StoreWriter::stored(const Meaning& meaning) const {
  const bool is_number = dimensionless_ && meaning.of == Meaning::Of::kModel && has_dimension(meaning.units);
  return is_number ? Meaning{"1", meaning.description} : meaning;
}

void StoreWriter::write(const std::string& name, double value, const Meaning& meaning) {
  target_->write(name, {}, &value, stored(meaning));
}

void StoreWriter::write(const std::string& name, std::int64_t value, const Meaning& meaning) {
  target_->write(name, {}, &value, stored(meaning));
}

void StoreWriter::write(const std::string& name, const std::string& value, const Meaning& meaning) {
  target_->write(name, {}, {&value, 1}, stored(meaning));
}

void StoreWriter::write(const std::string& name, const Eigen::VectorXd& values, const Meaning& meaning) {
  target_->write(name, {values.size()}, values.data(), stored(meaning));
}

void StoreWriter::write(const std::string& name, const std::vector<double>& values, const Meaning& meaning) {
  target_->write(name, {std::ssize(values)}, values.data(), stored(meaning));
}

void StoreWriter::write(const std::string& name, const std::vector<std::int64_t>& values, const Meaning& meaning) {
  target_->write(name, {std::ssize(values)}, values.data(), stored(meaning));
}

void StoreWriter::write(const std::string& name, const std::vector<std::string>& values, const Meaning& meaning) {
  target_->write(name, {std::ssize(values)}, values, stored(meaning));
}

void StoreWriter::write(const std::string& name, const Eigen::MatrixXd& values, const Meaning& meaning) {
  const Eigen::MatrixXd row_major = values.transpose();
  write_columns(name, row_major, meaning);
}

void StoreWriter::write_columns(const std::string& name, const Eigen::MatrixXd& values, const Meaning& meaning) {
  target_->write(name, {values.cols(), values.rows()}, values.data(), stored(meaning));
}

void StoreWriter::write(const Dataset& dataset) {
  if (dataset.kind == StoreEntry::Kind::kGroup) {
    describe_group(dataset.name, dataset.meaning.description);
  } else if (dataset.numbers != nullptr) {
    target_->write(dataset.name, dataset.shape, dataset.numbers.get(), stored(dataset.meaning));
  } else if (dataset.integers != nullptr) {
    target_->write(dataset.name, dataset.shape, dataset.integers.get(), stored(dataset.meaning));
  } else {
    target_->write(dataset.name, dataset.shape, dataset.texts, stored(dataset.meaning));
  }
}

void StoreWriter::describe_group(const std::string& name, const std::string& description) {
  target_->describe_group(name, description);
}

void StoreWriter::commit() { target_->commit(); }

const fs::path& StoreWriter::path() const { return target_->path(); }

}  // namespace slipmode::results
