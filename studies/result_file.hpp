#pragma once

#include <slipmode/pod/basis.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace slipmode::studies {

/// A result file in the making. Values that a long study finishes are kept in a journal beside it until the file is
/// whole; the same study, asked again after an interruption, goes on from there.
class ResultFile {
 public:
  /// @param command   what was asked, for provenance: with the scene, the version and `identity` it decides whether a
  ///                  journal found beside the file belongs to the same study
  /// @param identity  of what else decides values: the models of files, see identity_of
  /// @throws InvalidInput  as results::Journal
  ResultFile(std::filesystem::path path, scene::Scene scene, results::FileKind kind, std::string command,
             const std::string& identity = "");

  [[nodiscard]] results::Journal& journal() { return journal_; }
  /// Values that were found finished.
  [[nodiscard]] std::size_t resumed() const { return resumed_; }

  /// Writes provenance and what `write` adds under a temporary name, renames it and drops the journal.
  void finish(const std::function<void(results::StoreWriter&)>& write);

 private:
  std::filesystem::path path_;
  scene::Scene scene_;
  results::FileKind kind_;
  std::string command_;
  results::Journal journal_;
  std::size_t resumed_;
};

/// Short names of a file's bytes, and of a basis to the last bit.
[[nodiscard]] std::string identity_of(const std::filesystem::path& file);
[[nodiscard]] std::string identity_of(const pod::Basis& basis);

}  // namespace slipmode::studies
