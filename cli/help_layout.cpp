#include "cli/help_layout.hpp"

#include <slipmode/core/terminal.hpp>

#include <fmt/format.h>
#include <sstream>

namespace slipmode::cli {
namespace {

constexpr std::size_t kColumns = 80;

}  // namespace

std::string HelpLayout::make_description(const CLI::App* app) const {
  return wrapped(app->get_description(), kColumns) + "\n";
}

std::string HelpLayout::make_option_desc(const CLI::Option* option) const {
  return wrapped(option->get_description(), kColumns - column_width_);
}

std::string HelpLayout::make_subcommand(const CLI::App* verb) const {
  std::stringstream out;
  CLI::detail::format_help(out, verb->get_name(), wrapped(verb->get_description(), kColumns - column_width_),
                           column_width_);
  return out.str();
}

std::string HelpLayout::make_footer(const CLI::App* app) const { return wrapped_lines(app->get_footer(), kColumns); }

std::vector<HelpPage> pages_of(const CLI::App& root) {
  std::vector<HelpPage> pages = {{&root, root.get_name()}};
  for (std::size_t i = 0; i < pages.size(); ++i) {
    for (const CLI::App* verb : pages[i].app->get_subcommands({}))
      pages.push_back({verb, pages[i].words + " " + verb->get_name()});
  }
  return pages;
}

std::string tag_of(const CLI::Option& option) {
  const HelpLayout layout;
  return layout.make_option_name(&option, option.get_positional()) + layout.make_option_opts(&option);
}

std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();  // "TEXT:{bits,nats}", as CLI::IsMember writes it
  const std::size_t begin = type.find('{'), end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  return CLI::detail::split(type.substr(begin + 1, end - begin - 1), ',');
}

}  // namespace slipmode::cli
