#include <slipmode/diagnostics/attractors/farthest_dof.hpp>

#include <algorithm>
#include <deque>
#include <vector>

namespace slipmode::diagnostics {

Eigen::Index farthest_dof(const dynamics::HybridSystem& system) {
  const fem::SparseMatrix K = fem::to_sparse(system.structure().K());
  std::vector<int> links(static_cast<std::size_t>(K.rows()), -1);
  std::deque<Eigen::Index> front;
  const auto reach = [&](Eigen::Index dof, int distance) {
    int& reached = links[static_cast<std::size_t>(dof)];
    if (reached >= 0) return;
    reached = distance;
    front.push_back(dof);
  };
  for (const friction::Contact& contact : system.contacts())
    for (Eigen::Index i = 0; i < contact.direction.size(); ++i)
      if (contact.direction(i) != 0.0) reach(i, 0);
  for (; !front.empty(); front.pop_front())
    for (fem::SparseMatrix::InnerIterator entry(K, front.front()); entry; ++entry)
      if (entry.value() != 0.0) reach(entry.row(), links[static_cast<std::size_t>(front.front())] + 1);
  return std::ranges::max_element(links) - links.begin();
}

}  // namespace slipmode::diagnostics
