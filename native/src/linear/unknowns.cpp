// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/unknowns.h"

#include <complex>

#include "base/index.h"

namespace planar {

template <class Number>
Unknowns::Unknowns(CholeskySolver<Number>& solver, const std::vector<std::array<int, 2>>& edges,
                   const std::vector<char>& free)
    : size(0), slot(free.size(), -1) {
  for (std::size_t v = 0; v < free.size(); ++v) {
    if (free[v]) slot[v] = size++;
  }
  const auto make_pattern = [&] {
    std::vector<std::array<int, 2>> pairs;
    for (const auto& [a, b] : edges) {
      if (slot[at(a)] >= 0 && slot[at(b)] >= 0) pairs.push_back({slot[at(a)], slot[at(b)]});
    }
    return graph_pattern(size, pairs);
  };
  const std::vector<int> order = solver.fill_reducing_order(make_pattern());
  std::vector<int> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[at(order[k])] = static_cast<int>(k);
  for (int& number : slot) {
    if (number >= 0) number = place[at(number)];
  }
  pattern = make_pattern();
}

template Unknowns::Unknowns(CholeskySolver<double>&, const std::vector<std::array<int, 2>>&,
                            const std::vector<char>&);
template Unknowns::Unknowns(CholeskySolver<std::complex<double>>&, const std::vector<std::array<int, 2>>&,
                            const std::vector<char>&);

}  // namespace planar
