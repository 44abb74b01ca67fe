#include <slipmode/studies/result_file.hpp>

#include <slipmode/results/provenance.hpp>

#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <utility>

namespace slipmode::studies {

ResultFile::ResultFile(std::filesystem::path path, scene::Scene scene, results::FileKind kind, std::string command,
                       const std::string& identity)
    : path_(std::move(path)),
      scene_(std::move(scene)),
      kind_(kind),
      command_(std::move(command)),
      journal_(results::Journal::path_for(path_),
               results::fingerprint(fmt::format("{}\n{}\n{}\n{}", results::version(), command_, identity,
                                                scene::scene_to_toml(scene_)))),
      resumed_(journal_.records().size()) {}

void ResultFile::finish(const std::function<void(results::StoreWriter&)>& write) {
  results::StoreWriter writer(path_, kind_, scene_.units);
  results::save(writer, results::provenance_of(scene_, command_));
  write(writer);
  writer.commit();
  journal_.remove();
}

std::string identity_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return results::fingerprint({std::istreambuf_iterator<char>(in), {}});
}

std::string identity_of(const pod::Basis& basis) {
  std::string bytes = fmt::format("{} x {}\n", basis.vectors.rows(), basis.vectors.cols());
  const auto append = [&bytes](const auto& numbers) {
    bytes.append(reinterpret_cast<const char*>(numbers.data()),
                 static_cast<std::size_t>(numbers.size()) * sizeof(double));
  };
  append(basis.vectors);
  append(basis.mean);
  return results::fingerprint(bytes);
}

}  // namespace slipmode::studies
