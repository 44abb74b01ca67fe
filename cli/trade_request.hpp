#pragma once

#include <slipmode/scene/scene.hpp>
#include <slipmode/trade/measures.hpp>
#include <slipmode/trade/study.hpp>
#include "cli/session.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::cli {

/// "1%", "0.5 %", "2": percent. @throws InvalidInput  for anything else, or a number that is not positive
[[nodiscard]] double parse_percent(const std::string& option, const std::string& text);
/// "10s", "500ms", "2min": seconds. @throws InvalidInput  likewise
[[nodiscard]] double parse_duration(const std::string& option, const std::string& text);
/// @throws InvalidInput  for an unknown word, naming the valid ones
[[nodiscard]] trade::Measure parse_measure(const std::string& word);

/// A study with progress and, beside `output`, a journal of errors found, so that the same command goes on after
/// Ctrl-C. The journal is removed when `finish` has written the results.
/// @param output    empty: no journal
/// @param identity  of everything that decides the errors
/// @param finish    called with the finished study
void run_study(const Session& session, const std::filesystem::path& output, const std::string& identity,
               const std::function<trade::Study(trade::StudyOptions)>& study,
               const std::function<void(const trade::Study&)>& finish);

/// Writes a text under a temporary name and renames it.
/// @throws InvalidInput  when it cannot be written
void write_renamed(const std::filesystem::path& path, const std::string& text);

}  // namespace slipmode::cli
