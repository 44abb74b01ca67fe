#pragma once

namespace slipmode {

/// One visitor of a variant out of several lambdas.
template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;  // Clang before 17 does not deduce aggregates

}  // namespace slipmode
