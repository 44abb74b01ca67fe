#include <slipmode/figures/gnuplot.hpp>

#include <slipmode/core/errors.hpp>

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

extern char** environ;  // NOLINT: POSIX names it so

namespace slipmode::figures {
namespace {

namespace fs = std::filesystem;

/// A file in memory: a script can be handed over and messages taken back without a pipe that could fill up, and nothing
/// is left on disk whatever happens.
class MemoryFile {
 public:
  explicit MemoryFile(const char* name) : descriptor_(memfd_create(name, MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw std::runtime_error(fmt::format("memfd_create: {}", std::strerror(errno)));
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(descriptor_); }

  [[nodiscard]] int descriptor() const { return descriptor_; }

  void write_all(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = write(descriptor_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) throw std::runtime_error(fmt::format("writing gnuplot's script: {}", std::strerror(errno)));
      text.remove_prefix(static_cast<std::size_t>(written));
    }
    lseek(descriptor_, 0, SEEK_SET);
  }

  [[nodiscard]] std::string read_all() const {
    std::string text;
    char buffer[4096];
    lseek(descriptor_, 0, SEEK_SET);
    for (ssize_t got = 0; (got = read(descriptor_, buffer, sizeof buffer)) > 0;) {
      text.append(buffer, static_cast<std::size_t>(got));
    }
    return text;
  }

 private:
  int descriptor_;
};

std::string terminal_for(const Figure& figure, const fs::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".svg") {
    return fmt::format("svg enhanced size {},{} dynamic background rgb 'white' font 'sans-serif,17' linewidth 1.3",
                       figure.width(), figure.height());
  }
  if (extension == ".png") {
    return fmt::format("pngcairo enhanced size {},{} background rgb 'white' font 'Sans,14' linewidth 1.5",
                       figure.width(), figure.height());
  }
  return fmt::format("pdfcairo enhanced size {}in,{}in background rgb 'white' font 'Sans,13' linewidth 1.5",
                     0.01 * figure.width(), 0.01 * figure.height());
}

/// gnuplot's single-quoted string: only the quote itself is special, and is doubled.
std::string single_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

void run_gnuplot(const std::string& script) {
  // gnuplot reads standard input byte by byte, which takes longer than drawing; a file it reads in blocks.
  constexpr int kScript = 3;
  MemoryFile input("slipmode-gnuplot-script");
  MemoryFile messages("slipmode-gnuplot-messages");
  input.write_all(script);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, input.descriptor(), kScript);
  posix_spawn_file_actions_adddup2(&actions, messages.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, messages.descriptor(), STDERR_FILENO);
  // A process group of its own: Ctrl-C is for slipmode, which lets a figure be finished.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  char program[] = "gnuplot";
  char script_path[] = "/dev/fd/3";
  char* arguments[] = {program, script_path, nullptr};
  pid_t child = 0;
  const int failed = posix_spawnp(&child, program, &actions, &attributes, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failed == ENOENT) {
    throw InvalidInput("gnuplot is not installed or not in PATH; install it: apt-get install gnuplot-nox");
  }
  if (failed != 0) throw std::runtime_error(fmt::format("cannot start gnuplot: {}", std::strerror(failed)));

  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  throw std::runtime_error(fmt::format("gnuplot failed:\n{}", messages.read_all()));
}

/// Temporary names of the outputs; whatever has not been renamed is removed on leaving.
class PendingFiles {
 public:
  fs::path add(const fs::path& final) {
    fs::path temporary = final;
    temporary += fmt::format(".partial-{}", getpid());
    pending_.emplace_back(temporary, final);
    return temporary;
  }
  void commit() {
    for (const auto& [temporary, final] : pending_) fs::rename(temporary, final);
    pending_.clear();
  }
  PendingFiles() = default;
  PendingFiles(const PendingFiles&) = delete;
  PendingFiles& operator=(const PendingFiles&) = delete;
  ~PendingFiles() {
    std::error_code ignored;
    for (const auto& entry : pending_) fs::remove(entry.first, ignored);
  }

 private:
  std::vector<std::pair<fs::path, fs::path>> pending_;
};

void require_writable_folder(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (access(folder.c_str(), W_OK | X_OK) == 0) return;
  throw InvalidInput(fmt::format("cannot write figure '{}': folder '{}': {}; create it or choose another with -o",
                                 path.string(), folder.string(), std::strerror(errno)));
}

}  // namespace

std::string Figure::data(std::initializer_list<Eigen::Ref<const Eigen::VectorXd>> columns) {
  std::string name = fmt::format("$d{}", ++blocks_);
  auto out = std::back_inserter(data_);
  fmt::format_to(out, "{} << EOD\n", name);
  for (Eigen::Index row = 0; row < columns.begin()->size(); ++row) {
    bool finite = true;
    for (const auto& column : columns) finite = finite && std::isfinite(column[row]);
    if (finite) {
      for (const auto& column : columns) fmt::format_to(out, "{:.7g} ", column[row]);
    }
    data_ += '\n';
  }
  data_ += "EOD\n";
  return name;
}

void Figure::command(std::string_view line) {
  commands_ += line;
  commands_ += '\n';
}

void require_gnuplot() { run_gnuplot("set terminal svg\nset terminal pngcairo\nset terminal pdfcairo\n"); }

void require_figure_extension(const fs::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".svg" || extension == ".png" || extension == ".pdf") return;
  throw InvalidInput(fmt::format("figure '{}': the name must end in .svg, .png or .pdf", path.string()));
}

void save(const Figure& figure, const std::vector<fs::path>& paths) {
  PendingFiles files;
  std::string script = figure.data_blocks();
  for (const fs::path& path : paths) {
    require_figure_extension(path);
    require_writable_folder(path);
    script += fmt::format("reset\nset terminal {}\nset output {}\n", terminal_for(figure, path),
                          single_quoted(files.add(path).string()));
    script += figure.commands();
    script += "unset output\n";
  }
  run_gnuplot(script);
  files.commit();
}

std::string literal(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '"' || c == '\\' || c == '\n') continue;
    if (std::string_view("_^@&~{}").find(c) != std::string_view::npos) out += "\\\\";
    out += c;
  }
  return out;
}

}  // namespace slipmode::figures
