#include <slipmode/core/files.hpp>
#include <slipmode/results/provenance.hpp>
#include "cli/completion.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <sstream>

namespace slipmode::cli {
namespace {

namespace fs = std::filesystem;

/// Text as it is, in a manual page: no character of it is a command, dashes can be copied to a shell.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\\' ? std::string("\\e") : c == '-' ? std::string("\\-") : std::string(1, c);
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string tagged(const std::string& tag, const std::string& text) {
  return fmt::format(".TP\n.B {}\n{}\n", plain(tag), plain(text));
}

/// Notes as paragraphs; lines that are indented, which are commands, as they stand.
std::string paragraphs(const std::string& text) {
  std::istringstream lines(text);
  std::string out;
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    const bool is_command = line.starts_with("  ");
    if (is_command != inside) out += is_command ? ".PP\n.nf\n" : ".fi\n";
    inside = is_command;
    out += is_command ? plain(line) + "\n" : ".PP\n" + plain(line) + "\n";
  }
  return inside ? out + ".fi\n" : out;
}

std::string file_name(std::string words) {
  std::ranges::replace(words, ' ', '-');
  return words;
}

std::string manual_page(const HelpPage& page) {
  const CLI::App& app = *page.app;
  const std::string name = file_name(page.words), footer = app.get_footer();
  const std::size_t examples = std::min(footer.find("Example:\n"), footer.size());
  std::string title = name, synopsis, arguments, options, verbs;
  std::ranges::transform(title, title.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  for (const CLI::Option* option : app.get_options()) {
    const std::string entry = tagged(tag_of(*option), option->get_description());
    (option->get_positional() ? arguments : options) += entry;
    if (option->get_positional()) synopsis += " " + HelpLayout().make_option_usage(option);
  }
  for (const CLI::App* verb : app.get_subcommands({}))
    verbs += tagged(verb->get_name(), fmt::format("{}; see {}(1)", verb->get_description(),
                                                  file_name(page.words + " " + verb->get_name())));
  std::string out = fmt::format(".TH {} 1 \"\" \"slipmode {}\" \"User Commands\"\n", plain(title), results::version());
  out += fmt::format(".SH NAME\n{} \\- {}\n", plain(name), plain(app.get_description()));
  out += fmt::format(".SH SYNOPSIS\n.B {}\n[OPTIONS]{}{}\n", plain(page.words), plain(synopsis),
                     verbs.empty() ? "" : " VERB");
  if (examples > 0) out += ".SH DESCRIPTION\n" + paragraphs(footer.substr(0, examples));
  if (!verbs.empty()) out += ".SH VERBS\n" + verbs;
  if (!arguments.empty()) out += ".SH ARGUMENTS\n" + arguments;
  out += ".SH OPTIONS\n" + options;
  if (examples < footer.size()) out += ".SH EXAMPLES\n" + paragraphs(footer.substr(footer.find('\n', examples) + 1));
  return out;
}

Report run(const CLI::App& root, const fs::path& folder) {
  const std::vector<HelpPage> pages = pages_of(root);
  std::vector<std::pair<fs::path, std::string>> files = {
      {"bash-completion/completions/slipmode", bash_completion(pages)},
      {"zsh/vendor-completions/_slipmode", zsh_completion(pages)},
      {"fish/vendor_completions.d/slipmode.fish", fish_completion(pages)},
  };
  for (const HelpPage& page : pages) files.emplace_back("man/man1/" + file_name(page.words) + ".1", manual_page(page));
  Report report;
  report.data = {{"verb", "manual"}, {"folder", folder.string()}, {"files", Json::array()}};
  for (const auto& [name, text] : files) {
    std::error_code error;
    fs::create_directories((folder / name).parent_path(), error);
    require_writable((folder / name).string());
    write_renamed(folder / name, text);
    report.data["files"].push_back(name.string());
  }
  report.text =
      fmt::format("{} manual pages, and completion for bash, zsh and fish: {}\n", pages.size(), folder.string());
  return report;
}

}  // namespace

Verb add_manual(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("manual", "manual pages and shell completion, made from the help of all verbs");
  const auto folder = std::make_shared<std::string>();
  command->add_option("DIR", *folder, "folder for man/, bash-completion/, zsh/, fish/; made if missing")->required();
  command->footer(
      "The build calls it, and 'cmake --install' puts what it writes under share/.\n"
      "Example:\n  slipmode manual ~/.local/share");
  return {
      .command = command, .run = [&app, folder](const Session&) { return run(app, *folder); }, .reads_scene = false};
}

}  // namespace slipmode::cli
