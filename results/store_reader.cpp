#include <slipmode/core/errors.hpp>
#include <slipmode/results/store.hpp>
#include "results/internal/hdf5_handle.hpp"
#include "results/internal/seal.hpp"
#include "results/internal/store_ends.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cstring>
#include <fstream>

namespace slipmode::results {

namespace {

namespace fs = std::filesystem;

std::string why_not_opened(const fs::path& path) {
  if (!fs::exists(path)) return "no such file; check the path";
  if (fs::is_directory(path)) return "is a folder; expected a result file";
  if (!std::ifstream(path).good()) return "cannot be read; check its permissions";
  if (fs::file_size(path) == 0) return "is empty; make it again";
  if (!is_hdf5(path)) return "is not an HDF5 file; expected a result written by slipmode (or h5py, MATLAB)";
  return "is truncated or damaged HDF5; make it again";
}

std::string shape_text(const std::vector<std::int64_t>& shape) {
  if (shape.empty()) return "a scalar";
  return fmt::format("{}", fmt::join(shape, " x "));
}

std::string extent_text(Eigen::Index extent) {
  return extent == StoreReader::kAny ? std::string("any") : std::to_string(extent);
}

std::string child_name(const std::string& group, const std::string& name) {
  return group.empty() ? name : group + "/" + name;
}

std::string trim_padding(const char* data, std::size_t width) {
  std::string value(data, width);
  value.erase(std::find(value.begin(), value.end(), '\0'), value.end());
  return value;
}

/// Text of a dataset or attribute already opened, fixed or variable length alike.
template <class Read>
std::vector<std::string> read_texts(hid_t type, hid_t space, Read read, bool& out_ok) {
  const auto count = static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space)));
  std::vector<std::string> values(count);
  out_ok = true;
  if (count == 0) return values;
  if (H5Tis_variable_str(type) > 0) {
    std::vector<char*> pointers(count, nullptr);
    out_ok = read(pointers.data()) >= 0;
    for (std::size_t i = 0; out_ok && i < count; ++i) values[i] = pointers[i] != nullptr ? pointers[i] : "";
    if (out_ok) H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data());
    return values;
  }
  const std::size_t width = H5Tget_size(type);
  std::vector<char> padded(count * width);
  out_ok = read(padded.data()) >= 0;
  for (std::size_t i = 0; out_ok && i < count; ++i) values[i] = trim_padding(padded.data() + i * width, width);
  return values;
}

std::string attribute_text(hid_t object, const char* key) {
  if (H5Aexists(object, key) <= 0) return {};
  const Hdf5Handle attr(H5Aopen(object, key, H5P_DEFAULT), H5Aclose);
  const Hdf5Handle type(H5Aget_type(attr.id()), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attr.id()), H5Sclose);
  if (H5Tget_class(type.id()) != H5T_STRING) return {};
  bool ok = false;
  const auto values = read_texts(
      type.id(), space.id(), [&](void* out) { return H5Aread(attr.id(), type.id(), out); }, ok);
  return ok && !values.empty() ? values.front() : std::string();
}

StoreEntry::Kind entry_kind(H5T_class_t type_class) {
  switch (type_class) {
    case H5T_FLOAT:
      return StoreEntry::Kind::kDouble;
    case H5T_INTEGER:
      return StoreEntry::Kind::kInteger;
    case H5T_STRING:
      return StoreEntry::Kind::kText;
    default:
      return StoreEntry::Kind::kOther;
  }
}

class Hdf5Source final : public StoreSource {
 public:
  explicit Hdf5Source(fs::path source) : StoreSource(std::move(source)) {
    const QuietHdf5 quiet;
    if (const std::string damage = damage_of(path()); !damage.empty())
      throw InvalidInput(fmt::format("{}: {}; copy or make it again", path().string(), damage));
    file_ = Hdf5Handle(H5Fopen(path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!file_.valid()) throw InvalidInput(fmt::format("{}: {}", path().string(), why_not_opened(path())));
  }

  ~Hdf5Source() override {
    const QuietHdf5 quiet;
    set_.reset();
    file_.reset();
  }

  /// H5Lexists wants every part of the path to be there, so they are asked for one by one.
  [[nodiscard]] bool has(const std::string& name) const override {
    const QuietHdf5 quiet;
    for (std::size_t end = name.find('/');; end = name.find('/', end + 1)) {
      if (H5Lexists(file_.id(), name.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
      if (end == std::string::npos) return true;
    }
  }

  [[nodiscard]] std::vector<std::string> names(const std::string& group) const override {
    const QuietHdf5 quiet;
    const Hdf5Handle object(H5Gopen2(file_.id(), group.empty() ? "/" : group.c_str(), H5P_DEFAULT), H5Gclose);
    if (!object.valid()) fail(group, "no such group; see `slipmode info` for what the file holds");
    std::vector<std::string> found;
    const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* data) -> herr_t {
      static_cast<std::vector<std::string>*>(data)->emplace_back(name);
      return 0;
    };
    if (H5Literate(object.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &found) < 0) {
      fail(group, "cannot be listed; the file is damaged, make it again");
    }
    return found;
  }

  [[nodiscard]] std::string attribute(const std::string& key) const override {
    const QuietHdf5 quiet;
    const Hdf5Handle root(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose);
    return attribute_text(root.id(), key.c_str());
  }

  [[nodiscard]] StoreEntry entry(const std::string& name) const override {
    const QuietHdf5 quiet;
    StoreEntry found;
    found.name = name;
    found.kind = StoreEntry::Kind::kOther;
    const Hdf5Handle object(H5Oopen(file_.id(), name.c_str(), H5P_DEFAULT), H5Oclose);
    if (!object.valid()) return found;  // a dangling link in somebody else's file
    found.meaning = {attribute_text(object.id(), "units"), attribute_text(object.id(), "description")};
    const H5I_type_t object_type = H5Iget_type(object.id());
    if (object_type == H5I_GROUP) found.kind = StoreEntry::Kind::kGroup;
    if (object_type != H5I_DATASET) return found;
    const Opened opened = opened_of(object.id());
    found.kind = opened.kind;
    found.shape = opened.shape;
    return found;
  }

  Opened open(const std::string& name) override {
    const QuietHdf5 quiet;
    name_ = name;
    set_ = Hdf5Handle(H5Dopen2(file_.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!set_.valid()) fail(name, "is a group or damaged; expected a dataset");
    return opened_of(set_.id());
  }

  void read(double* out_values) const override { read(H5T_NATIVE_DOUBLE, out_values); }
  void read(std::int64_t* out_values) const override { read(H5T_NATIVE_INT64, out_values); }

  [[nodiscard]] std::vector<std::string> texts() const override {
    const QuietHdf5 quiet;
    const Hdf5Handle type(H5Dget_type(set_.id()), H5Tclose);
    const Hdf5Handle space(H5Dget_space(set_.id()), H5Sclose);
    bool ok = false;
    auto values = read_texts(
        type.id(), space.id(),
        [&](void* out) { return H5Dread(set_.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, out); }, ok);
    if (!ok) fail(name_, "cannot be read; the file is truncated or damaged, make it again");
    return values;
  }

 private:
  [[nodiscard]] static Opened opened_of(hid_t set) {
    const Hdf5Handle type(H5Dget_type(set), H5Tclose);
    const Hdf5Handle space(H5Dget_space(set), H5Sclose);
    if (H5Sget_simple_extent_type(space.id()) == H5S_NULL) return {StoreEntry::Kind::kOther, {}};  // h5py's Empty
    std::vector<hsize_t> extents(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space.id()))));
    H5Sget_simple_extent_dims(space.id(), extents.data(), nullptr);
    return {entry_kind(H5Tget_class(type.id())), {extents.begin(), extents.end()}};
  }

  void read(hid_t memory_type, void* out) const {
    const QuietHdf5 quiet;
    if (H5Dread(set_.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) < 0)
      fail(name_, "cannot be read; the file is truncated or damaged, make it again");
  }

  Hdf5Handle file_, set_;
  std::string name_;
};

}  // namespace

void StoreSource::fail(const std::string& name, const std::string& what) const {
  throw InvalidInput(fmt::format("{}: {}: {}", path_.string(), name, what));
}

StoreSource::Opened StoreSource::open_present(const std::string& name) {
  if (has(name)) return open(name);
  const std::size_t slash = name.rfind('/');
  const std::string group = slash == std::string::npos ? "" : name.substr(0, slash);
  const std::string near = group.empty() || has(group) ? fmt::format("{}", fmt::join(names(group), ", ")) : "";
  fail(name, fmt::format("missing from the file{}; was it written by another verb?",
                         near.empty() ? "" : fmt::format(" ({} holds: {})", group.empty() ? "it" : group, near)));
}

std::vector<std::int64_t> StoreSource::open_as(const std::string& name, StoreEntry::Kind wanted, const char* what,
                                               std::initializer_list<Eigen::Index> shape) {
  const Opened found = open_present(name);
  const bool counts = wanted == StoreEntry::Kind::kDouble && found.kind == StoreEntry::Kind::kInteger;
  if (found.kind != wanted && !counts) fail(name, fmt::format("expected {}, found another type", what));
  const bool fits = std::ranges::equal(found.shape, shape, [](std::int64_t have, Eigen::Index want) {
    return want == StoreReader::kAny || have == want;
  });
  if (fits) return found.shape;
  std::vector<std::string> expected;
  for (const Eigen::Index extent : shape) expected.push_back(extent_text(extent));
  const std::string text = expected.empty() ? "a scalar" : fmt::format("{}", fmt::join(expected, " x "));
  fail(name, fmt::format("wrong shape: expected {}, found {}; does the file belong to another scene?", text,
                         shape_text(found.shape)));
}

StoreReader::StoreReader(fs::path path) : source_(std::make_unique<Hdf5Source>(std::move(path))) {}
StoreReader::StoreReader(std::shared_ptr<const MemoryStore> store) : source_(memory_source(std::move(store))) {}
StoreReader::~StoreReader() = default;
StoreReader::StoreReader(StoreReader&&) noexcept = default;
StoreReader& StoreReader::operator=(StoreReader&&) noexcept = default;

double StoreReader::number(const std::string& name) const {
  source_->open_as(name, StoreEntry::Kind::kDouble, "a number", {});
  double value = 0.0;
  source_->read(&value);
  return value;
}

std::int64_t StoreReader::integer(const std::string& name) const {
  source_->open_as(name, StoreEntry::Kind::kInteger, "an integer", {});
  std::int64_t value = 0;
  source_->read(&value);
  return value;
}

std::string StoreReader::text(const std::string& name) const {
  source_->open_as(name, StoreEntry::Kind::kText, "a text", {});
  return source_->texts().at(0);
}

Eigen::VectorXd StoreReader::vector(const std::string& name, Eigen::Index size) const {
  Eigen::VectorXd values(source_->open_as(name, StoreEntry::Kind::kDouble, "numbers", {size})[0]);
  source_->read(values.data());
  return values;
}

std::vector<std::int64_t> StoreReader::integers(const std::string& name, Eigen::Index size) const {
  const auto shape = source_->open_as(name, StoreEntry::Kind::kInteger, "integers", {size});
  std::vector<std::int64_t> values(static_cast<std::size_t>(shape[0]));
  source_->read(values.data());
  return values;
}

std::vector<std::string> StoreReader::texts(const std::string& name, Eigen::Index size) const {
  source_->open_as(name, StoreEntry::Kind::kText, "texts", {size});
  return source_->texts();
}

Eigen::MatrixXd StoreReader::matrix(const std::string& name, Eigen::Index rows, Eigen::Index cols) const {
  return columns(name, cols, rows).transpose();
}

Eigen::MatrixXd StoreReader::columns(const std::string& name, Eigen::Index rows, Eigen::Index cols) const {
  const auto shape = source_->open_as(name, StoreEntry::Kind::kDouble, "a matrix of numbers", {cols, rows});
  Eigen::MatrixXd values(shape[1], shape[0]);
  source_->read(values.data());
  return values;
}

Dataset StoreReader::dataset(const std::string& name) const {
  Dataset found{entry(name)};
  if (found.kind == StoreEntry::Kind::kGroup) return found;
  source_->open(name);
  const auto read = [&]<class T>(std::shared_ptr<const T>& out) {
    const std::shared_ptr<T[]> values(new T[found.count()]);
    source_->read(values.get());
    out = {values, values.get()};
  };
  if (found.kind == StoreEntry::Kind::kDouble) {
    read(found.numbers);
  } else if (found.kind == StoreEntry::Kind::kInteger) {
    read(found.integers);
  } else if (found.kind == StoreEntry::Kind::kText) {
    found.texts = source_->texts();
  }
  return found;
}

std::string StoreReader::attribute(const std::string& key) const { return source_->attribute(key); }

bool StoreReader::has(const std::string& name) const { return source_->has(name); }

std::vector<std::string> StoreReader::names(const std::string& group) const { return source_->names(group); }

StoreEntry StoreReader::entry(const std::string& name) const {
  if (!has(name)) source_->fail(name, "missing from the file");
  return source_->entry(name);
}

std::vector<StoreEntry> StoreReader::entries() const {
  std::vector<StoreEntry> found;
  const auto visit = [&](const auto& self, const std::string& group) -> void {
    for (const std::string& name : names(group)) {
      found.push_back(entry(child_name(group, name)));
      const StoreEntry latest = found.back();
      if (latest.kind == StoreEntry::Kind::kGroup) self(self, latest.name);
    }
  };
  visit(visit, "");
  return found;
}

const fs::path& StoreReader::path() const { return source_->path(); }

void StoreReader::fail(const std::string& name, const std::string& what) const { source_->fail(name, what); }

}  // namespace slipmode::results
