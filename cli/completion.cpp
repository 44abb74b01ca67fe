#include "cli/completion.hpp"

#include <slipmode/results/part.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slipmode::cli {
namespace {

using results::shell_word;

/// Each of an option's names, with its dashes.
std::vector<std::string> dashed(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::string joined(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

/// Arms of a shell's `case` over "$verb $word": which words lead from one verb to the next.
std::string descent(const std::vector<HelpPage>& pages) {
  std::vector<std::string> patterns;
  for (std::size_t i = 1; i < pages.size(); ++i) patterns.push_back("\"" + pages[i].words + "\"");
  return fmt::format("      {}) verb=\"$verb $word\";;\n", fmt::join(patterns, "|"));
}

/// Arms of a `case` over "$verb $previous": what the words of an option's value can be.
std::string values(const std::vector<HelpPage>& pages) {
  std::string arms;
  for (const HelpPage& page : pages) {
    for (const CLI::Option* option : page.app->get_options()) {
      const std::vector<std::string> choices = choices_of(*option);
      if (choices.empty()) continue;
      for (const std::string& name : dashed(*option))
        arms += fmt::format("    \"{} {}\") choices=({});;\n", page.words, name, joined(choices));
    }
  }
  return arms;
}

}  // namespace

std::string bash_completion(const std::vector<HelpPage>& pages) {
  std::string arms;
  for (const HelpPage& page : pages) {
    std::vector<std::string> verbs, options;
    for (const CLI::App* verb : page.app->get_subcommands({})) verbs.push_back(verb->get_name());
    for (const CLI::Option* option : page.app->get_options()) {
      for (const std::string& name : dashed(*option)) options.push_back(name);
    }
    arms += fmt::format("    \"{}\") verbs=({}) options=({});;\n", page.words, joined(verbs), joined(options));
  }
  return fmt::format(R"(# bash completion for slipmode, written by 'slipmode manual'
_slipmode() {{
  local cur=$2 verb=slipmode word
  local -a verbs=() options=() choices=() words
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "$verb $word" in
{}    esac
  done
  case "$verb $3" in
{}  esac
  case "$verb" in
{}  esac
  words=("${{verbs[@]}}")
  [[ $cur != -* ]] || words=("${{options[@]}}")
  [[ ${{#choices[@]}} -eq 0 ]] || words=("${{choices[@]}}")
  mapfile -t COMPREPLY < <(compgen -W "${{words[*]}}" -- "$cur")
}}
complete -o bashdefault -o default -F _slipmode slipmode
)",
                     descent(pages), values(pages), arms);
}

std::string zsh_completion(const std::vector<HelpPage>& pages) {
  std::string arms;
  for (const HelpPage& page : pages) {
    std::string verbs, options;
    for (const CLI::App* verb : page.app->get_subcommands({}))
      verbs += " " + shell_word(verb->get_name() + ":" + verb->get_description());
    for (const CLI::Option* option : page.app->get_options()) {
      for (const std::string& name : dashed(*option))
        options += " " + shell_word(name + ":" + option->get_description());
    }
    arms += fmt::format("    \"{}\")\n      verbs=({})\n      options=({});;\n", page.words, verbs, options);
  }
  return fmt::format(R"(#compdef slipmode
# zsh completion for slipmode, written by 'slipmode manual'
_slipmode() {{
  local verb=slipmode word
  local -a verbs options choices
  for word in "${{(@)words[2,CURRENT-1]}}"; do
    case "$verb $word" in
{}    esac
  done
  case "$verb $words[CURRENT-1]" in
{}  esac
  case "$verb" in
{}  esac
  if (( $#choices )); then
    compadd -a choices
  elif [[ $PREFIX == -* ]]; then
    _describe -o option options
  elif (( $#verbs )); then
    _describe verb verbs
  else
    _files
  fi
}}
_slipmode "$@"
)",
                     descent(pages), values(pages), arms);
}

std::string fish_completion(const std::vector<HelpPage>& pages) {
  std::string lines = "# fish completion for slipmode, written by 'slipmode manual'\n";
  for (const HelpPage& page : pages) {
    std::vector<std::string> conditions;
    for (const CLI::App* app = page.app; app->get_parent() != nullptr; app = app->get_parent())
      conditions.push_back("__fish_seen_subcommand_from " + app->get_name());
    std::vector<std::string> verbs;
    for (const CLI::App* verb : page.app->get_subcommands({})) verbs.push_back(verb->get_name());
    if (!verbs.empty()) conditions.push_back("not __fish_seen_subcommand_from " + joined(verbs));
    const std::string head =
        fmt::format("complete -c slipmode -n {}", shell_word(fmt::format("{}", fmt::join(conditions, "; and "))));
    for (const CLI::App* verb : page.app->get_subcommands({}))
      lines += fmt::format("{} -f -a {} -d {}\n", head, verb->get_name(), shell_word(verb->get_description()));
    for (const CLI::Option* option : page.app->get_options()) {
      if (option->get_positional()) continue;
      std::string line = head;
      for (const std::string& name : option->get_snames()) line += " -s " + name;
      for (const std::string& name : option->get_lnames()) line += " -l " + name;
      if (option->get_items_expected_max() != 0) line += " -r";
      const std::vector<std::string> choices = choices_of(*option);
      if (!choices.empty()) line += fmt::format(" -f -a {}", shell_word(joined(choices)));
      lines += fmt::format("{} -d {}\n", line, shell_word(option->get_description()));
    }
  }
  return lines;
}

}  // namespace slipmode::cli
