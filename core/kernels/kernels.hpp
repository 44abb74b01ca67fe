#pragma once

#include <cstddef>
#include <vector>

/// The inner loops of the flows, compiled once for every vector width and chosen when the program starts: plain arrays
/// in, plain arrays out, eight lanes at a time (collocation nodes, or pairs). Sums have one order whatever the width:
/// AVX2 and AVX-512 give the same bytes.
///
/// Arrays are faster aligned to 64 bytes, and need not be. `np` is the number of pairs padded to a multiple of eight; a
/// state is [x₁; x₂], 2np. A table of eight nodes by columns is stored column by column.
namespace slipmode::kernels {

using Index = std::ptrdiff_t;

/// G of all pairs and what acts on them: ẋ = G x + load + Σ_c input_c λ_c.
struct PairArrays {
  Index np = 0;
  int contacts = 0;
  const double *g11, *g12, *g21, *g22;  ///< [np]
  const double* load;                   ///< [2np]; null: none acts
  const double* input;                  ///< [2np x contacts]
  int powers = 8;                       ///< of t in the contacts' forces, from 0
  int given = 0;                        ///< the last so many contacts are directions of a drive's forces
};

/// x(h) = E x + load + response · forces.
struct StepArrays {
  Index np = 0;
  int columns = 0;  ///< of `response`
  const double *e11, *e12, *e21, *e22;
  const double* load;      ///< [2np]; null: left out
  const double* response;  ///< [2np x columns]
};

/// Viscous loss over a step as a form of the state and of the forces at the nodes, λ [8 contacts]:
/// Σ_i (s₁₁ x₁² + s₁₂ x₁x₂ + s₂₂ x₂²)_i + linear·x + constant + Σ_c λ_cᵀ(by_force_c x + load_c + Σ_d kernel_cd λ_d).
struct LossArrays {
  Index n = 0, np = 0;
  int contacts = 0;
  const double* by_force;         ///< [8 x 2np contacts]
  const double* load;             ///< [8 contacts]
  const double* kernel;           ///< [8 x 8] blocks, those of d = 0 … for c = 0 first
  const double *s11, *s12, *s22;  ///< [np]
  const double* linear;           ///< [2np]; null: no constant load
  double constant = 0.0;
};
inline constexpr int kMostTerms = 32;  ///< of a Taylor series
inline constexpr int kWorkPoints = 6;  ///< of the Gauss rule for squares of its velocities
inline constexpr int kMoments = 40;    ///< of forces with its powers, padded to a multiple of eight

/// A quadrature rule on [0, 1] for motion given by its Taylor series.
struct SeriesRule {
  double at_node[kMostTerms][kWorkPoints];  ///< node_p^{k+1} / (k + 1)!
  double weight[kWorkPoints];
};
/// For ∫₀¹ a b dt of a polynomial a of degree 7 and a b of degree 8: Radau's rule, which is exact to degree 14, and
/// what the two leading terms add: a's last Legendre coefficient by what b is short of at 0.
struct ProductRule {
  alignas(64) double weight[8], last_of_a[8], start_of_b[8];
};
struct Work {
  double contact = 0.0, force = 0.0, loss = 0.0;  ///< done by contacts, by a drive's forces, and lost
};

/// One contact over one trial step: what is known, what is sought.
struct Trial {
  Index n = 0, np = 0;
  const double* free;    ///< velocities at the nodes by the state [8 x 2np]
  const double* load;    ///< and by the load [8]
  const double* kernel;  ///< and by the forces [8 x 8]
  double kernel_norm = 0.0;
  const double* x;      ///< state [2np]
  const double* drive;  ///< V at the nodes [8]
  /// Stribeck's law: λ = sign (kinetic + drop e^{−α sign (V − v)}).
  double sign = 1.0, kinetic = 0.0, drop = 0.0, alpha = 0.0;
  /// Takes the last step's velocities to these nodes; null: `forces` hold the guess [8 x 8].
  const double* ahead;
  double force_error = 0.0;  ///< that Newton may leave, as a share of kinetic + drop
  double* forces;            ///< [8]
  double* velocity;          ///< of the last step, then of this one [8]
};

/// Pairs that oscillate: e^{Gt} = e^{τt}(cos wt I + sin wt A), A = (G − τI)/w of trace zero.
struct MotionArrays {
  Index np = 0;
  const double *decay, *frequency;  ///< τ and w [np]
  const double *a11, *a12, *a21;    ///< A [np]
};

/// What a certain time changes of pairs that move freely, D = e^{Gt} − I, and the scales that their sizes are measured
/// in.
struct ChangeArrays {
  Index np = 0;
  const double *d11, *d12, *d21, *d22;  ///< [np]
  const double *scale1, *scale2;        ///< [np]
};

/// What one width offers.
struct Kernels {
  const char* name;

  double (*dot)(const double* a, const double* b, Index size);  ///< size a multiple of eight
  /// ∫₀¹ a b dt of a, by its values at the nodes, and b, by those and the one at 0.
  double (*product_integral)(const ProductRule& rule, const double* a, const double* b, double b_start);
  /// y += a x.
  void (*add_scaled)(double a, const double* x, double* y, Index size);
  /// out += A x. @param A  [rows x columns], rows a multiple of eight
  void (*product)(const double* A, Index rows, Index columns, const double* x, double* out);
  /// The same of two vectors at once: A is read once.
  void (*two_products)(const double* A, Index rows, Index columns, const double* x, const double* y, double* out_x,
                       double* out_y);
  /// out = Σ_i column_i x_i + start [8]; start may be null.
  void (*node_sums)(const double* columns, const double* x, Index count, const double* start, double* out);
  /// y = A x, A [8 x 8].
  void (*matrix8)(const double* A, const double* x, double* out);

  /// Solves λ_j = law(v_j) at the nodes; v = free x + load + kernel λ. False without convergence: forces and velocity
  /// are then worth nothing.
  bool (*solve_stribeck)(const Trial& trial);
  /// The forces that hold v = V: forces = inverse (V − free x − load).
  void (*solve_stick)(const Trial& trial, const double* inverse);
  /// Velocities under the forces given.
  void (*solve_sliding)(const Trial& trial);
  /// (I − A diag(d)) δ = r by elimination without pivots. False when that does not solve it: δ is then worth nothing.
  bool (*solve_nodes)(const double* A, const double* d, const double* r, double* out_delta);
  /// aᵀx and bᵀx [8].
  void (*two_dots)(const double* a, const double* b, const double* x, double& out_a, double& out_b);
  /// Bernstein coefficients 1 … 8 of sign (V − v) by its values at the nodes and at the start. @return  the least
  double (*speed_guard)(const double* bernstein, const double* by_start, double start, double sign, const double* drive,
                        const double* velocity, double* out);
  /// Bernstein coefficients of the forces [8]. @return  the largest in size
  double (*force_guard)(const double* bernstein, const double* forces, double* out);

  /// In place if asked.
  void (*propagate)(const StepArrays& step, const double* x, const double* forces, double* out_x);
  double (*loss)(const LossArrays& form, const double* x, const double* forces);
  /// x(τ) by Taylor's series of so many terms; in place if asked. @param coefficient  of (t/τ)^k in the contacts'
  /// forces, times τ [8 x contacts]
  void (*taylor)(const PairArrays& pairs, const double* x, const double* coefficient, double tau, int terms,
                 double* out_x);
  /// Over [0, τ] of the same motion: ∫ Σ λ_c velocity_rowᵀx dt, term by term, and ∫ Σ damping x₂² dt by the
  /// rule. @param velocity_row  [2np x contacts] @param damping  [np]; null: no loss, but the states at the
  /// rule's points @param out_moments  worked in [kMoments x contacts] @param out_x  for those states [2np x
  /// kWorkPoints]
  Work (*taylor_work)(const PairArrays& pairs, const double* velocity_row, const double* damping, const double* x,
                      const double* coefficient, double tau, int terms, const SeriesRule& rule, double* out_moments,
                      double* out_x);
  /// x += (e^{Gt} − I) free, each part of the difference by itself: short times and slow pairs lose nothing.
  void (*free_motion)(const MotionArrays& pairs, double t, const double* free, double* x);
  /// D = e^{Gt} − I at several times, a column for each: d11, d12, d21, d22 of all pairs. @param out  [4np x count]
  void (*changes)(const MotionArrays& pairs, const double* times, Index count, double* out);
  /// What the velocities are at one time, by forces whose shares of the time before are given: out = Σ_l (a u_l + b
  /// v_l) w_l for eight forces. @param a, b  [np] @param u, v  [np x points] @param w  [8 x points] @param out  [np x
  /// 8]
  void (*caused)(Index np, Index points, const double* a, const double* b, const double* u, const double* v,
                 const double* w, double* out);
  /// out += Aᵀ diag(weight) B. @param A, B  [np x 8] @param out  [8 x 8]
  void (*weighted_products)(Index np, const double* A, const double* B, const double* weight, double* out);
  /// x += D free, free += D free, and the new sizes scale₁ |free₁| + scale₂ |free₂| [np].
  void (*pass)(const ChangeArrays& change, double* x, double* free, double* out_size);
};

/// The sets that this processor runs, widest first.
[[nodiscard]] const std::vector<const Kernels*>& available();
/// The set in use: the widest the processor runs, or the one SLIPMODE_KERNELS names (avx512, avx2, generic).
/// @throws InvalidInput  for another name, or a set this processor does not run
[[nodiscard]] const Kernels& kernels();

}  // namespace slipmode::kernels
