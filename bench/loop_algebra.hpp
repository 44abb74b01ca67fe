#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace slipmode::bench {

/// odeint's own algebras iterate element by element through iterators; this one tells the compiler that the arrays do
/// not overlap, which lets it vectorise.
struct LoopAlgebra {
  template <class Op, class First, class... Rest>
  static void loop(Op op, First& first, Rest&... rest) {
    const std::size_t n = first.size();
    auto* out = first.data();
    const auto in = std::make_tuple(rest.data()...);
    std::apply(
        [&](auto*... pointers) {
#pragma GCC ivdep
          for (std::size_t i = 0; i < n; ++i) op(out[i], pointers[i]...);
        },
        in);
  }
  template <class A, class Op>
  static void for_each1(A& a, Op op) {
    loop(op, a);
  }
  template <class A, class B, class Op>
  static void for_each2(A& a, B& b, Op op) {
    loop(op, a, b);
  }
  template <class A, class B, class C, class Op>
  static void for_each3(A& a, B& b, C& c, Op op) {
    loop(op, a, b, c);
  }
  template <class A, class B, class C, class D, class Op>
  static void for_each4(A& a, B& b, C& c, D& d, Op op) {
    loop(op, a, b, c, d);
  }
  template <class A, class B, class C, class D, class E, class Op>
  static void for_each5(A& a, B& b, C& c, D& d, E& e, Op op) {
    loop(op, a, b, c, d, e);
  }
  template <class A, class B, class C, class D, class E, class F, class Op>
  static void for_each6(A& a, B& b, C& c, D& d, E& e, F& f, Op op) {
    loop(op, a, b, c, d, e, f);
  }
  template <class A, class B, class C, class D, class E, class F, class G, class Op>
  static void for_each7(A& a, B& b, C& c, D& d, E& e, F& f, G& g, Op op) {
    loop(op, a, b, c, d, e, f, g);
  }
  template <class A, class B, class C, class D, class E, class F, class G, class H, class Op>
  static void for_each8(A& a, B& b, C& c, D& d, E& e, F& f, G& g, H& h, Op op) {
    loop(op, a, b, c, d, e, f, g, h);
  }
  template <class A>
  static auto norm_inf(const A& a) {
    typename A::value_type largest = 0;
    for (const auto value : a) largest = std::max(largest, std::abs(value));
    return largest;
  }
};

}  // namespace slipmode::bench
