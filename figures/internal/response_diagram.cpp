#include "figures/internal/response_diagram.hpp"

#include <slipmode/core/to_vector.hpp>
#include <slipmode/figures/style.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace slipmode::figures {
namespace {

/// Curves of one look: pieces separated by blank lines.
struct Pieces {
  std::vector<double> x, y;

  void add(double px, double py) {
    x.push_back(px);
    y.push_back(py);
  }
  void break_here() { add(std::numeric_limits<double>::quiet_NaN(), 0.0); }
  [[nodiscard]] std::string data(Figure& figure) const { return figure.data({to_vector(x), to_vector(y)}); }
};

struct Looks {
  Pieces stable, unstable;
};

/// A piece ends with the first point of the next, so that curves have no holes where stability changes.
Looks looks_of(const ResponseBranch& branch) {
  Looks looks;
  for (Eigen::Index k = 0; k < branch.parameter.size(); ++k) {
    const bool now = branch.stable[static_cast<std::size_t>(k)];
    Pieces& own = now ? looks.stable : looks.unstable;
    const bool changed = k > 0 && branch.stable[static_cast<std::size_t>(k - 1)] != now;
    if (changed) {
      own.break_here();
      own.add(branch.parameter[k - 1], branch.value[k - 1]);
    }
    own.add(branch.parameter[k], branch.value[k]);
  }
  return looks;
}

/// Outlines of a branch's band, one for each stretch along which it is known.
std::string band_data(Figure& figure, const ResponseBranch& branch, std::vector<Series>& out_drawn) {
  Pieces outlines, back;
  const auto close = [&] {
    for (std::size_t k = back.x.size(); k-- > 0;) outlines.add(back.x[k], back.y[k]);
    if (!back.x.empty()) outlines.break_here();
    back = {};
  };
  for (Eigen::Index k = 0; k < branch.band.size(); ++k) {
    const double half = branch.band[k];
    if (std::isinf(half)) close();
    if (!std::isfinite(half)) continue;
    outlines.add(branch.parameter[k], branch.value[k] + half);
    back.add(branch.parameter[k], branch.value[k] - half);
  }
  close();
  if (!outlines.x.empty())
    out_drawn.push_back({"true error", to_vector(outlines.x), to_vector(outlines.y), Series::Look::kLine, kPomColour});
  return outlines.x.empty() ? "" : outlines.data(figure);
}

std::vector<std::string> kinds_of(const std::vector<ResponseMark>& marks) {
  std::vector<std::string> kinds;
  for (const ResponseMark& mark : marks) {
    if (std::ranges::find(kinds, mark.kind) == kinds.end()) kinds.push_back(mark.kind);
  }
  return kinds;
}

void add_marks(Figure& figure, const std::vector<ResponseMark>& marks, std::vector<std::string>& plots,
               std::vector<Series>& out_drawn) {
  constexpr std::array kSymbols = {7, 5, 9, 13, 6, 4, 8, 12, 2};  // filled, then open ones
  constexpr std::array<std::string_view, 4> kColours = {kLnmColour, kSecondColour, "#CC79A7", "#E69F00"};
  std::vector<std::string> kinds = kinds_of(marks);
  std::ranges::sort(kinds);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    Pieces points;
    for (const ResponseMark& mark : marks) {
      if (mark.kind == kinds[k]) points.add(mark.parameter, mark.value);
    }
    out_drawn.push_back(
        {kinds[k], to_vector(points.x), to_vector(points.y), Series::Look::kPoints, kColours[k % kColours.size()]});
    plots.push_back(fmt::format("{} using 1:2 with points pointtype {} pointsize 1.1 linecolor rgb '{}' title \"{}\"",
                                points.data(figure), kSymbols[k % kSymbols.size()], kColours[k % kColours.size()],
                                literal(kinds[k])));
  }
}

std::string joined(const std::vector<std::string>& plots) {
  std::string all;
  for (const std::string& plot : plots) all += (all.empty() ? "plot " : ", ") + plot;
  return all.empty() ? "plot NaN notitle" : all;
}

}  // namespace

Figure response_diagram(const std::vector<ResponseBranch>& branches, const std::vector<ResponseMark>& marks,
                        const ResponseLabels& labels) {
  Figure figure(1200, 760);
  common_style(figure);
  double low_x = INFINITY, high_x = -INFINITY, low_y = INFINITY, high_y = -INFINITY;
  std::vector<std::string> plots;
  std::vector<Series> drawn;
  bool has_band = false, has_unstable = false;
  for (const ResponseBranch& branch : branches) {
    if (branch.parameter.size() == 0) continue;
    low_x = std::min(low_x, branch.parameter.minCoeff());
    high_x = std::max(high_x, branch.parameter.maxCoeff());
    low_y = std::min(low_y, branch.value.minCoeff());
    high_y = std::max(high_y, branch.value.maxCoeff());
    for (Eigen::Index k = 0; k < branch.band.size(); ++k) {
      if (!std::isfinite(branch.band[k])) continue;
      low_y = std::min(low_y, branch.value[k] - branch.band[k]);
      high_y = std::max(high_y, branch.value[k] + branch.band[k]);
    }
    if (const std::string band = band_data(figure, branch, drawn); !band.empty()) {
      plots.push_back(fmt::format(
          "{} using 1:2 with filledcurves closed fillstyle transparent solid 0.3 noborder fillcolor rgb '{}' {}", band,
          kPomColour, has_band ? "notitle" : "title 'true error'"));
      has_band = true;
    }
    const Looks looks = looks_of(branch);
    if (!looks.stable.x.empty()) {
      drawn.push_back(
          {branch.title, to_vector(looks.stable.x), to_vector(looks.stable.y), Series::Look::kLine, branch.colour});
      plots.push_back(fmt::format(
          "{} using 1:2 with lines linewidth 1.8 linecolor rgb '{}' {}", looks.stable.data(figure), branch.colour,
          branch.title.empty() ? "notitle" : fmt::format("title \"{}\"", literal(branch.title))));
    }
    has_unstable |= !looks.unstable.x.empty();
    if (!looks.unstable.x.empty()) {
      drawn.push_back(
          {"unstable", to_vector(looks.unstable.x), to_vector(looks.unstable.y), Series::Look::kDashed, branch.colour});
      plots.push_back(fmt::format("{} using 1:2 with lines dashtype 2 linewidth 1.5 linecolor rgb '{}' notitle",
                                  looks.unstable.data(figure), branch.colour));
    }
  }
  if (has_unstable) plots.push_back("NaN with lines dashtype 2 linewidth 1.5 linecolor rgb '#222222' title 'unstable'");
  add_marks(figure, marks, plots, drawn);
  figure.show({.panels = {{.series = drawn, .x_label = labels.parameter, .y_label = labels.value}}});
  // The left margin is what ticks and label need.
  figure.command("set rmargin at screen 0.98; set bmargin at screen 0.11; set tmargin at screen 0.84");
  figure.command("set key at screen 0.985,0.985 right top horizontal maxrows 3 width 1");
  figure.command(fmt::format("set xrange {}; set yrange {}", padded_range(low_x, high_x), padded_range(low_y, high_y)));
  figure.command(fmt::format("set xlabel \"{}\"; set ylabel \"{}\"", labels.parameter, labels.value));
  figure.command(joined(plots));
  return figure;
}

Figure multiplier_plane(const Eigen::MatrixXd& parts, const std::string& title) {
  Figure figure(760, 760);
  common_style(figure);
  const double reach = std::max(1.1, 1.08 * parts.cwiseAbs().maxCoeff());
  const std::string data = figure.data({parts.col(0), parts.col(1)});
  const Eigen::VectorXd angle = Eigen::VectorXd::LinSpaced(181, 0.0, 2.0 * std::numbers::pi);
  figure.show(
      {.panels = {{.title = title,
                   .series = {{"unit circle", angle.array().cos(), angle.array().sin(), Series::Look::kLine, "#888888"},
                              {"", parts.col(0), parts.col(1), Series::Look::kPoints, kFullColour}},
                   .x_label = "real part [–]",
                   .y_label = "imaginary part [–]"}}});
  figure.command("set size ratio -1; set parametric; set trange [0:2*pi]; set samples 400");
  figure.command(fmt::format("set xrange [{:.4g}:{:.4g}]; set yrange [{:.4g}:{:.4g}]", -reach, reach, -reach, reach));
  figure.command("set xlabel 'real part [–]'; set ylabel 'imaginary part [–]'");
  figure.command(fmt::format("set title \"{}\"", literal(title)));
  figure.command(
      fmt::format("plot cos(t), sin(t) with lines linecolor rgb '#888888' notitle, {} using 1:2 "
                  "with points pointtype 7 pointsize 1.1 linecolor rgb '{}' notitle",
                  data, kFullColour));
  return figure;
}

}  // namespace slipmode::figures
