#pragma once

#include <slipmode/figures/drawing.hpp>

#include <Eigen/Core>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slipmode::figures {

/// A figure as gnuplot draws it: inline data blocks, then the commands that use them.
///
/// The commands are run once per output format, after the terminal is set, so they must not set one.
class Figure {
 public:
  /// @param width, height  size in pixels of the PNG (the SVG has the same view box; a PDF is width/100 inches wide)
  Figure(int width, int height) : width_(width), height_(height) {}

  /// Stores columns of equal length as a data block. A row that holds a value which is not finite becomes a blank line:
  /// it breaks a curve there.
  /// @return the block's name, to be used after `plot`
  std::string data(std::initializer_list<Eigen::Ref<const Eigen::VectorXd>> columns);

  /// Appends one line of commands.
  void command(std::string_view line);

  /// Tells what is shown.
  void show(Drawing drawing) { drawing_ = std::move(drawing); }
  [[nodiscard]] const Drawing& drawing() const { return drawing_; }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] const std::string& data_blocks() const { return data_; }
  [[nodiscard]] const std::string& commands() const { return commands_; }

 private:
  int width_, height_;
  int blocks_ = 0;
  std::string data_, commands_;
  Drawing drawing_;
};

/// Throws unless the path ends in .svg, .png or .pdf: to be called before any work that would be lost.
/// @throws InvalidInput  naming the path and the three choices
void require_figure_extension(const std::filesystem::path& path);

/// Throws unless gnuplot can be started and has what draws SVG, PNG and PDF: to be called before any work that would be
/// lost.
/// @throws InvalidInput  saying how to install it
/// @throws std::runtime_error  when it lacks one of the three; the message holds what it said
void require_gnuplot();

/// Draws the figure into each path; the extension picks the format. One gnuplot process, started without a shell, draws
/// all of them; each file is written under a temporary name and renamed, so that no half-written figure is left.
/// @throws InvalidInput  for an unknown extension, a folder that can't be written, or when gnuplot is not installed
/// @throws std::runtime_error  when gnuplot fails; the message holds what it said
void save(const Figure& figure, const std::vector<std::filesystem::path>& paths);

/// Text as it is, in gnuplot's enhanced mode: the characters that would change the type are escaped, quotes removed.
[[nodiscard]] std::string literal(std::string_view text);

}  // namespace slipmode::figures
