#include <slipmode/figures/energy_shares.hpp>

#include <slipmode/figures/style.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <utility>

namespace slipmode::figures {
namespace {

/// 1 − cumulative share in %, summed from the small end so that nothing is lost in 1 − (nearly 1). The last mode, which
/// leaves nothing, is dropped: a logarithm has no place for it.
Eigen::VectorXd left_out(const Eigen::VectorXd& shares) {
  const Eigen::Index n = shares.size();
  Eigen::VectorXd rest = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = n - 2; i >= 0; --i) rest[i] = rest[i + 1] + shares[i + 1];
  return 100.0 * rest.head(std::max<Eigen::Index>(n - 1, 0));
}

Eigen::VectorXd numbers(Eigen::Index count) {
  return Eigen::VectorXd::LinSpaced(count, 1.0, static_cast<double>(count));
}

}  // namespace

Figure energy_shares(const EnergyShares& shares) {
  Figure figure(1200, 560);
  common_style(figure);
  const Eigen::Index n = std::min<Eigen::Index>(shares.pom.size(), 40);
  const Eigen::VectorXd pom = 100.0 * shares.pom.head(n);
  const Eigen::VectorXd rest = left_out(shares.pom).head(std::min<Eigen::Index>(n, shares.pom.size() - 1));
  const double smallest = std::max(1e-12, 100.0 * shares.pom.head(n).minCoeff());

  Drawing::Axes each{.title = "share of each proper orthogonal mode",
                     .series = {{"", numbers(n), pom, Series::Look::kPoints, kPomColour}},
                     .x_label = "mode",
                     .y_label = "energy share [%]",
                     .log_y = true};
  Drawing::Axes kept{.title = "what the first L modes leave out",
                     .series = {{"POM", numbers(rest.size()), rest, Series::Look::kMarkedLine, kPomColour}},
                     .x_label = "number of modes kept, L",
                     .y_label = "energy left out [%]",
                     .log_y = true};

  figure.command("set multiplot layout 1,2 margins 0.085,0.985,0.165,0.91 spacing 0.095,0");
  figure.command(fmt::format("set xrange [0.4:{}]", static_cast<double>(n) + 0.6));
  figure.command(fmt::format("set logscale y; set yrange [{:.3g}:160]", 0.5 * smallest));
  figure.command("set format y '10^{%L}'");
  if (n <= 20) figure.command("set xtics 1");
  figure.command("set xlabel \"mode\"; set ylabel \"energy share [%]\"");
  figure.command("set title \"share of each proper orthogonal mode\" offset 0,-0.5");
  figure.command("unset key; set style fill solid 0.85 noborder; set boxwidth 0.7");
  const std::string bars = figure.data({numbers(n), pom});
  figure.command(fmt::format("plot {} using 1:2 with boxes linecolor rgb '{}'", bars, kPomColour));

  const double threshold = 100.0 * (1.0 - shares.threshold);
  figure.command("set xlabel \"number of modes kept, L\"; set ylabel \"energy left out [%]\"");
  figure.command("set title \"what the first L modes leave out\" offset 0,-0.5");
  figure.command("set key top right");
  std::string plot = "plot ";
  if (threshold > 0.0) {
    kept.series.push_back({fmt::format("{:g} % kept", 100.0 * shares.threshold), numbers(rest.size()),
                           Eigen::VectorXd::Constant(rest.size(), threshold), Series::Look::kDashed, "#666666"});
    plot += fmt::format("{:.6g} with lines dashtype 3 linewidth 1.2 linecolor rgb '#666666' title '{:g} % kept', ",
                        threshold, 100.0 * shares.threshold);
  }
  plot += fmt::format("{} using 1:2 with linespoints pointtype 7 linewidth 1.6 linecolor rgb '{}' title 'POM'",
                      figure.data({numbers(rest.size()), rest}), kPomColour);
  const Eigen::Index compared = std::min<Eigen::Index>(shares.lnm_captured.size(), rest.size());
  if (compared > 0) {
    const Eigen::VectorXd lnm = 100.0 * (1.0 - shares.lnm_captured.head(compared).array()).max(1e-14);
    kept.series.push_back({"LNM", numbers(compared), lnm, Series::Look::kMarkedLine, kLnmColour});
    plot += fmt::format(
        ", {} using 1:2 with linespoints pointtype 4 dashtype 2 linewidth 1.6 linecolor rgb '{}' "
        "title 'LNM'",
        figure.data({numbers(compared), lnm}), kLnmColour);
  }
  figure.command(plot);
  figure.command("unset multiplot");
  figure.show({.panels = {std::move(each), std::move(kept)}, .columns = 2});
  return figure;
}

}  // namespace slipmode::figures
