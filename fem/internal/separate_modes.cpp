#include "fem/internal/separate_modes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace slipmode::fem::detail {
namespace {

/// Couplings and gaps below these shares of the largest entry make vectors that are not orthogonal.
constexpr double kSmallestCoupling = 1e-6, kSmallestGap = 1e-8;
/// The recurrence's rounding adds up like √n: 1.3e-16 √n is the largest residual of uniform chains of 1,000 to 20,000.
constexpr double kLargestResidual = 1e-14, kResidualPerRoot = 4e-16, kLargestLoss = 1e-11;
/// Newton's next step, foreseen from the last two, no longer matters below this.
constexpr double kConverged = 1e-17;
constexpr double kRounding = 4e-16;
constexpr int kMostPasses = 200;

/// Sixteen numbers side by side, as vectors of the widest registers that the library is compiled for.
constexpr std::size_t kSide = 16, kParts = 4;
using Part = double __attribute__((vector_size(32)));
using Bits = std::int64_t __attribute__((vector_size(32)));

struct Lanes {
  std::array<Part, kParts> part;

  explicit Lanes(double value) {
    for (Part& p : part) p = Part{value, value, value, value};
  }
  void set(std::size_t lane, double value) { part[lane / 4][lane % 4] = value; }
  [[nodiscard]] double operator[](std::size_t lane) const { return part[lane / 4][lane % 4]; }
};

struct Tridiagonal16 {
  Eigen::Index n;
  const double *diagonal, *squares;  ///< [n], [n − 1]
};

/// 2^−k for numbers of size 2^k. Vectors are neither returned nor passed by value: how, depends on the registers that
/// are compiled for. A cast between them takes the bits as they are.
void scale_of(const Part& a, Part& out_scale) {
  constexpr std::int64_t exponent = 0x7ff0000000000000, twice_bias = 0x7fe0000000000000;
  const Bits own = (Bits)a & exponent, back = twice_bias - own;
  out_scale = (Part)back;
}

/// The characteristic polynomial's leading minors at x, by their three-term recurrence.
struct Minors {
  Lanes below{0.0};   ///< eigenvalues below x, by changes of sign
  Lanes newton{0.0};  ///< p / p′ of the whole matrix, if asked for
  Lanes sign{0.0};    ///< p, scaled
};

template <bool with_slope>
void minors(const Tridiagonal16& T, const Lanes& at, Minors& out) {
  for (std::size_t k = 0; k < kParts; k += 2) {  // two chains of operations at a time
    Part x[2], p[2], before[2], slope[2], slope_before[2];
    Bits changes[2];
    for (std::size_t i = 0; i < 2; ++i) {
      x[i] = at.part[k + i];
      before[i] = Part{1.0, 1.0, 1.0, 1.0};
      p[i] = T.diagonal[0] - x[i];
      slope_before[i] = Part{};
      slope[i] = -before[i];
      changes[i] = (Bits)p[i] < 0;
    }
    for (Eigen::Index j = 1; j < T.n; ++j) {
      const double d = T.diagonal[j], square = T.squares[j - 1];
#pragma GCC unroll 2
      for (std::size_t i = 0; i < 2; ++i) {
        const Part next = (d - x[i]) * p[i] - square * before[i];
        if constexpr (with_slope) {
          const Part next_slope = (d - x[i]) * slope[i] - (square * slope_before[i] + p[i]);
          slope_before[i] = slope[i];
          slope[i] = next_slope;
        } else {
          changes[i] += ((Bits)next ^ (Bits)p[i]) < 0;
        }
        before[i] = p[i];
        p[i] = next;
      }
      if (j % 8 != 0) continue;
#pragma GCC unroll 2
      for (std::size_t i = 0; i < 2; ++i) {
        Part s;
        scale_of(p[i] * p[i] > before[i] * before[i] ? p[i] : before[i], s);
        p[i] *= s;
        before[i] *= s;
        slope[i] *= s;
        slope_before[i] *= s;
      }
    }
    for (std::size_t i = 0; i < 2; ++i) {
      out.newton.part[k + i] = p[i] / slope[i];
      out.sign.part[k + i] = p[i];
      out.below.part[k + i] = -__builtin_convertvector(changes[i], Part);
    }
  }
}

struct Interval {
  double lo, hi;
  Eigen::Index below, above;  ///< eigenvalues below lo and below hi
};

/// Intervals of one eigenvalue each, ascending; nothing where some are too close.
std::optional<std::vector<Interval>> isolate(const Tridiagonal16& T, double lo, double hi) {
  std::vector<Interval> open{{lo, hi, 0, T.n}}, next, alone;
  Minors found;
  while (!open.empty()) {
    next.clear();
    for (std::size_t first = 0; first < open.size(); first += kSide) {
      const std::size_t count = std::min(kSide, open.size() - first);
      Lanes middle(0.0);
      for (std::size_t i = 0; i < count; ++i) middle.set(i, (open[first + i].lo + open[first + i].hi) / 2.0);
      minors<false>(T, middle, found);
      for (std::size_t i = 0; i < count; ++i) {
        const Interval& own = open[first + i];
        const auto below = static_cast<Eigen::Index>(found.below[i]);
        if (own.hi - own.lo < kSmallestGap || below < own.below || below > own.above) return std::nullopt;
        for (const Interval& part :
             {Interval{own.lo, middle[i], own.below, below}, Interval{middle[i], own.hi, below, own.above}})
          if (part.above - part.below > 0) (part.above - part.below == 1 ? alone : next).push_back(part);
      }
    }
    open.swap(next);
  }
  std::sort(alone.begin(), alone.end(), [](const Interval& a, const Interval& b) { return a.below < b.below; });
  return alone;
}

/// The eigenvalue in each interval: Newton inside a shrinking bracket.
std::optional<Eigen::VectorXd> refine(const Tridiagonal16& T, std::vector<Interval>& intervals) {
  const auto n = intervals.size();
  Eigen::VectorXd value(T.n), last = Eigen::VectorXd::Zero(T.n);  // steps; 0: none
  std::vector<Eigen::Index> active(n);
  for (std::size_t k = 0; k < n; ++k) {
    active[k] = static_cast<Eigen::Index>(k);
    value(active[k]) = (intervals[k].lo + intervals[k].hi) / 2.0;
  }
  Minors found;
  for (int pass = 0; !active.empty(); ++pass) {
    if (pass == kMostPasses) return std::nullopt;
    std::size_t kept = 0;
    for (std::size_t first = 0; first < active.size(); first += kSide) {
      const std::size_t count = std::min(kSide, active.size() - first);
      Lanes x(0.0);
      for (std::size_t i = 0; i < count; ++i) x.set(i, value(active[first + i]));
      minors<true>(T, x, found);
      for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Index k = active[first + i];
        Interval& own = intervals[static_cast<std::size_t>(k)];
        const bool above = (found.sign[i] > 0.0) == (own.below % 2 == 0);  // it lies above x
        (above ? own.lo : own.hi) = x[i];
        const double step = found.newton[i], size = std::abs(step), to = x[i] - step;
        if (found.sign[i] == 0.0 || size <= kRounding) {
          if (found.sign[i] != 0.0) value(k) = to;
          continue;
        }
        if (to > own.lo && to < own.hi) {
          value(k) = to;
          const double shrunk = size / last(k);
          if (shrunk < 0.1 && size * shrunk * shrunk < kConverged) continue;
          last(k) = size;
        } else {
          value(k) = (own.lo + own.hi) / 2.0;
          last(k) = 0.0;
          if (own.hi - own.lo <= kRounding) continue;
        }
        active[kept++] = k;
      }
    }
    active.resize(kept);
  }
  return value;
}

/// Eigenvectors of sixteen eigenvalues by the recurrence from either end.
class TwoEnds {
 public:
  TwoEnds(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off_diagonal, const Eigen::MatrixXd& rows)
      : d_(diagonal),
        e_(off_diagonal),
        inverse_(off_diagonal.cwiseInverse()),
        allowed_(std::max(kLargestResidual, kResidualPerRoot * std::sqrt(static_cast<double>(diagonal.size())))),
        rows_(rows),
        down_(static_cast<std::size_t>(diagonal.size()), Lanes(1.0)),
        up_(down_) {}

  /// @param values  corrected by Rayleigh's quotient @param out_rows  of the vectors of length 1 [m x count]
  /// @return        false where a residual is too large
  [[nodiscard]] bool find(Eigen::Ref<Eigen::VectorXd> values, Eigen::Ref<Eigen::MatrixXd> out_rows) {
    const auto n = d_.size();
    const auto count = static_cast<std::size_t>(values.size());
    Lanes x(values(0));
    for (std::size_t i = 0; i < count; ++i) x.set(i, values(static_cast<Eigen::Index>(i)));
    recur(x);
    Lanes best(0.0), where(0.0);
    for (Eigen::Index j = 0; j < n; ++j)
      for (std::size_t k = 0; k < kParts; ++k) {
        const Part both = down_[at(j)].part[k] * up_[at(j)].part[k], size = both > 0.0 ? both : -both;
        const Bits larger = size > best.part[k];
        best.part[k] = larger ? size : best.part[k];
        where.part[k] = larger ? Part{} + static_cast<double>(j) : where.part[k];
      }
    Lanes by_down(0.0), by_up(0.0), squares(0.0);
    for (std::size_t i = 0; i < kSide; ++i) {
      const auto r = static_cast<Eigen::Index>(where[i]);
      by_down.set(i, 1.0 / down_[at(r)][i]);
      by_up.set(i, 1.0 / up_[at(r)][i]);
    }
    std::vector<Lanes> sums(static_cast<std::size_t>(rows_.rows()), Lanes(0.0));
    for (Eigen::Index j = 0; j < n; ++j) {
      Lanes u(0.0);
      for (std::size_t k = 0; k < kParts; ++k) {
        u.part[k] = static_cast<double>(j) <= where.part[k] ? down_[at(j)].part[k] * by_down.part[k]
                                                            : up_[at(j)].part[k] * by_up.part[k];
        squares.part[k] += u.part[k] * u.part[k];
      }
      for (Eigen::Index m = 0; m < rows_.rows(); ++m)
        if (const double y = rows_(m, j); y != 0.0)
          for (std::size_t k = 0; k < kParts; ++k) sums[at(m)].part[k] += y * u.part[k];
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto r = static_cast<Eigen::Index>(where[i]);
      double residual = d_(r) - x[i];
      if (r > 0) residual += e_(r - 1) * down_[at(r - 1)][i] * by_down[i];
      if (r + 1 < n) residual += e_(r) * up_[at(r + 1)][i] * by_up[i];
      const double length = std::sqrt(squares[i]);
      if (!(std::abs(residual) <= allowed_ * length)) return false;
      const auto k = static_cast<Eigen::Index>(i);
      values(k) += residual / squares[i];
      for (Eigen::Index m = 0; m < rows_.rows(); ++m) out_rows(m, k) = sums[at(m)][i] / length;
    }
    return true;
  }

 private:
  static std::size_t at(Eigen::Index j) { return static_cast<std::size_t>(j); }

  void recur(const Lanes& x) {
    const auto n = d_.size();
    for (Eigen::Index j = 0; j + 1 < n; ++j)
      for (std::size_t k = 0; k < kParts; ++k) {
        Part next = ((x.part[k] - d_(j)) * inverse_(j)) * down_[at(j)].part[k];
        if (j > 0) next -= (e_(j - 1) * inverse_(j)) * down_[at(j - 1)].part[k];
        down_[at(j + 1)].part[k] = next;
      }
    for (Eigen::Index j = n - 1; j > 0; --j)
      for (std::size_t k = 0; k < kParts; ++k) {
        Part next = ((x.part[k] - d_(j)) * inverse_(j - 1)) * up_[at(j)].part[k];
        if (j + 1 < n) next -= (e_(j) * inverse_(j - 1)) * up_[at(j + 1)].part[k];
        up_[at(j - 1)].part[k] = next;
      }
  }

  const Eigen::VectorXd &d_, &e_;
  Eigen::VectorXd inverse_;
  double allowed_;  ///< residual
  const Eigen::MatrixXd& rows_;
  std::vector<Lanes> down_, up_;
};

}  // namespace

std::optional<SeparateModes> separate_modes(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off_diagonal,
                                            const Eigen::MatrixXd& rows) {
  const auto n = diagonal.size();
  if (n < 2 || !(off_diagonal.cwiseAbs().minCoeff() > kSmallestCoupling)) return std::nullopt;
  const Eigen::VectorXd squares = off_diagonal.cwiseAbs2();
  const Tridiagonal16 T{n, diagonal.data(), squares.data()};
  const double reach = 2.0 * off_diagonal.cwiseAbs().maxCoeff() + kSmallestGap;
  auto intervals = isolate(T, diagonal.minCoeff() - reach, diagonal.maxCoeff() + reach);
  if (!intervals) return std::nullopt;
  auto values = refine(T, *intervals);
  if (!values) return std::nullopt;

  SeparateModes modes{std::move(*values), Eigen::MatrixXd(rows.rows(), n)};
  TwoEnds vectors(diagonal, off_diagonal, rows);
  for (Eigen::Index k = 0; k < n; k += kSide) {
    const auto count = std::min<Eigen::Index>(kSide, n - k);
    if (!vectors.find(modes.values.segment(k, count), modes.rows.middleCols(k, count))) return std::nullopt;
  }
  if ((modes.values.tail(n - 1) - modes.values.head(n - 1)).minCoeff() < kSmallestGap) return std::nullopt;
  const Eigen::VectorXd size = rows.rowwise().norm();
  const Eigen::MatrixXd loss = modes.rows * modes.rows.transpose() - rows * rows.transpose();
  if (!(loss.array().abs() <= kLargestLoss * (size * size.transpose()).array()).all()) return std::nullopt;
  return modes;
}

}  // namespace slipmode::fem::detail
