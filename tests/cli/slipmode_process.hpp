#pragma once

#include "scene/messages.hpp"
#include "scene/temporary_folder.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

extern char** environ;  // NOLINT: POSIX names it so

namespace slipmode::tests {

inline void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Of a command line, and more of them.
using Words = std::vector<std::string>;
inline Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// How a call of the executable ended, and what it said.
struct Outcome {
  int exit_code = -1;  ///< -1 when a signal ended it
  int signal = 0;
  std::string out, err;

  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/// The executable of the build that this test program is of.
inline std::string executable() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "cli" / "slipmode";
}

/// The executable itself, started without a shell in a given folder; its output goes to files outside that folder.
class SlipmodeProcess {
 public:
  /// @param launcher  program and words before the executable: mpirun
  SlipmodeProcess(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                  std::vector<std::string> launcher = {}) {
    std::vector<std::string> words = std::move(launcher);
    words.push_back(executable());
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = (said_.path() / "out").string(), err = (said_.path() / "err").string();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    const int failed = posix_spawn(&id_, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) throw std::runtime_error("cannot start " + words[0]);
  }
  ~SlipmodeProcess() {
    if (!running_) return;
    kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
  }
  SlipmodeProcess(const SlipmodeProcess&) = delete;
  SlipmodeProcess& operator=(const SlipmodeProcess&) = delete;

  /// Sends a signal as soon as `ready` holds. @return false when the process ended before
  bool signal_when(const std::function<bool()>& ready, int signal) {
    while (!ready()) {
      if (waitpid(id_, &status_, WNOHANG) == id_) {
        running_ = false;
        return false;
      }
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    return kill(id_, signal) == 0;
  }

  [[nodiscard]] pid_t id() const { return id_; }

  Outcome wait() {
    if (running_) waitpid(id_, &status_, 0);
    running_ = false;
    return {.exit_code = WIFEXITED(status_) ? WEXITSTATUS(status_) : -1,
            .signal = WIFSIGNALED(status_) ? WTERMSIG(status_) : 0,
            .out = bytes_of(said_.path() / "out"),
            .err = bytes_of(said_.path() / "err")};
  }

 private:
  TemporaryFolder said_;
  pid_t id_ = 0;
  int status_ = 0;
  bool running_ = true;
};

inline Outcome slipmode_in(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
  return SlipmodeProcess(arguments, folder.path()).wait();
}

/// PNG's eight first bytes (PNG specification, 5.2) or SVG's root element.
inline bool is_figure(const std::filesystem::path& path) {
  const std::string bytes = bytes_of(path);
  if (path.extension() == ".png") return bytes.starts_with("\x89PNG\r\n\x1a\n") && bytes.size() > 1000;
  return bytes.find("<svg") != std::string::npos && bytes.find("</svg>") != std::string::npos;
}

}  // namespace slipmode::tests
