#include <slipmode/pod/pod_of_ranks.hpp>

#include <slipmode/core/errors.hpp>
#include "pod/internal/accumulator.hpp"
#include "pod/internal/assemble.hpp"
#include "pod/internal/shares.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <functional>

namespace slipmode::pod {

namespace {

constexpr Eigen::Index kColumns = 256;  // that travel at once

/// Matrices that are fetched one by one: one is on its way at a time, so that memory holds no more of them.
void give(Exchange& exchange, int to, std::size_t count, const std::function<Eigen::MatrixXd(std::size_t)>& matrix) {
  for (std::size_t i = 0; i < count; ++i) {
    (void)exchange.bytes_from(to);  // it asks
    const Eigen::MatrixXd next = matrix(i);
    exchange.send(to, std::span<const double>(next.data(), static_cast<std::size_t>(next.size())));
  }
  (void)exchange.bytes_from(to);  // it has all: MPI sends while it is called only
}

Eigen::MatrixXd fetch(Exchange& exchange, int from, Eigen::Index rows) {
  exchange.send(from, "");
  const std::vector<double> numbers = exchange.numbers_from(from);
  return Eigen::Map<const Eigen::MatrixXd>(numbers.data(), rows, static_cast<Eigen::Index>(numbers.size()) / rows);
}

/// Every rank's numbers, on every rank; each gives as many.
std::vector<std::vector<double>> gather(Exchange& exchange, const std::vector<double>& own) {
  std::vector<std::vector<double>> all(static_cast<std::size_t>(exchange.count()), own);
  for (int rank = 1; rank < exchange.count(); ++rank) {
    auto& numbers = all[static_cast<std::size_t>(rank)];
    if (exchange.own() == rank) exchange.send(0, own);
    if (exchange.own() == 0) numbers = exchange.numbers_from(rank);
  }
  for (auto& numbers : all) {
    if (exchange.own() != 0) numbers = exchange.numbers_from(0);
    for (int rank = 1; exchange.own() == 0 && rank < exchange.count(); ++rank) exchange.send(rank, numbers);
  }
  return all;
}

Shares gather_shares(Exchange& exchange, const Eigen::MatrixXd& share) {
  const Eigen::Index n = share.rows();
  std::vector<Eigen::Index> counts;
  for (const auto& of_rank : gather(exchange, {static_cast<double>(n), static_cast<double>(share.cols())})) {
    if (of_rank[0] != static_cast<double>(n)) {
      throw InvalidInput(
          fmt::format("POD of ranks: snapshots of rank {} have {} rows, those of rank {} have {}; "
                      "expected the same of all",
                      exchange.own(), n, counts.size(), of_rank[0]));
    }
    counts.push_back(static_cast<Eigen::Index>(of_rank[1]));
  }
  return {counts, block_size(n)};
}

/// Heads change ranks. @return those that are this rank's now, in order, side by side
Eigen::MatrixXd exchange_heads(Exchange& exchange, const Shares& shares, const Eigen::MatrixXd& share) {
  Eigen::Index coming = 0;
  for (int from = exchange.own() + 1; from < shares.ranks(); ++from)
    if (shares.head_owner(from) == exchange.own()) coming += shares.head(from);
  Eigen::MatrixXd got(share.rows(), coming);
  Eigen::Index begin = 0;
  for (int from = 1; from < shares.ranks(); ++from) {
    const Eigen::Index head = shares.head(from);
    if (head == 0) continue;
    const auto part = [head](Eigen::Index first) { return std::min(kColumns, head - first); };
    if (exchange.own() == from) {
      give(exchange, shares.head_owner(from), static_cast<std::size_t>((head + kColumns - 1) / kColumns),
           [&](std::size_t i) {
             const Eigen::Index first = static_cast<Eigen::Index>(i) * kColumns;
             return share.middleCols(first, part(first));
           });
    } else if (exchange.own() == shares.head_owner(from)) {
      for (Eigen::Index first = 0; first < head; first += kColumns, begin += part(first - kColumns))
        got.middleCols(begin, part(first)) = fetch(exchange, from, share.rows());
      exchange.send(from, "");
    }
  }
  return got;
}

void add(BlockStream& blocks, const Eigen::Ref<const Eigen::MatrixXd>& snapshots, const Exchange& exchange) {
  for (Eigen::Index begin = 0; begin < snapshots.cols(); begin += kColumns) {
    exchange.check_interrupt();
    blocks.add(snapshots.middleCols(begin, std::min(kColumns, snapshots.cols() - begin)));
  }
}

void give_triangle(Exchange& exchange, int to, const SnapshotTriangle& sum) {
  const Eigen::Index n = sum.R.cols();
  give(exchange, to, static_cast<std::size_t>(1 + (n + kTriangleRows - 1) / kTriangleRows), [&](std::size_t i) {
    if (i > 0) return rows_of(sum, static_cast<Eigen::Index>(i - 1) * kTriangleRows);
    Eigen::MatrixXd head(n, 3);
    head << Eigen::VectorXd::Constant(n, static_cast<double>(sum.count)), sum.origin, sum.mean;
    return head;
  });
}

void join_from(Exchange& exchange, int from, SnapshotTriangle& sum) {
  const Eigen::Index n = sum.R.cols();
  const Eigen::MatrixXd head = fetch(exchange, from, n);
  const SnapshotTriangle other{
      .count = static_cast<Eigen::Index>(head(0, 0)), .origin = head.col(1), .mean = head.col(2), .R = {}};
  join(sum, other, [&](Eigen::Index k) { return fetch(exchange, from, std::min(kTriangleRows, n - k)); });
  exchange.send(from, "");
}

/// Rank 0 goes on when no other waits for a parcel any more: what it sends next is not the exchange's.
void wait_for_all(Exchange& exchange) {
  if (exchange.own() != 0) exchange.send(0, "");
  for (int rank = 1; exchange.own() == 0 && rank < exchange.count(); ++rank) (void)exchange.bytes_from(rank);
}

}  // namespace

std::optional<PodResult> pod_of_ranks(const Eigen::MatrixXd& share, Exchange& exchange, const PodOptions& options) {
  if (options.method != PodMethod::kAutomatic && options.method != PodMethod::kQrSvd)
    throw InvalidInput("POD of ranks: only the QR method takes snapshots from several; choose kAutomatic or kQrSvd");
  const Shares shares = gather_shares(exchange, share);
  const int own = exchange.own();
  check_finite(share, shares.begin(own));
  check_counts(share.rows(), shares.snapshots());
  validate(options, share.rows());
  const Eigen::MatrixXd more = exchange_heads(exchange, shares, share);
  if (shares.blocks() == 1) {
    wait_for_all(exchange);
    if (own != 0) return std::nullopt;
    Ensemble all{.snapshots = Eigen::MatrixXd(share.rows(), shares.snapshots())};
    all.snapshots.leftCols(share.cols()) = share;
    all.snapshots.rightCols(more.cols()) = more;
    return pod(all, options);
  }

  BlockStream blocks(share.rows(), options.remove_mean, shares.first_block(own));
  add(blocks, share.rightCols(share.cols() - shares.head(own)), exchange);
  add(blocks, more, exchange);
  std::vector<JoinedBlocks> triangles = blocks.take();
  for (const Join& one : joins_of(shares)) {
    exchange.check_interrupt();
    if (one.into == own && one.from == own) {
      join(triangles[one.into_place].sum, triangles[one.from_place].sum);
    } else if (one.into == own) {
      join_from(exchange, one.from, triangles[one.into_place].sum);
    } else if (one.from == own) {
      give_triangle(exchange, one.into, triangles[one.from_place].sum);
      triangles[one.from_place].sum.R.resize(0, 0);
    }
  }
  wait_for_all(exchange);
  if (own != 0) return std::nullopt;
  return modes_of(triangles.front().sum, options);
}

}  // namespace slipmode::pod
