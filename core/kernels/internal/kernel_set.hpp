#pragma once

#include <slipmode/core/kernels/kernels.hpp>

// The kernels of one width, in a namespace of its name: what every source here defines, and what kernel_set.cpp
// gathers.

namespace slipmode::kernels {

namespace SLIPMODE_KERNEL_SET {

double dot(const double* a, const double* b, Index size);
double product_integral(const ProductRule& rule, const double* a, const double* b, double b_start);
void add_scaled(double a, const double* x, double* y, Index size);
void product(const double* A, Index rows, Index columns, const double* x, double* out);
void two_products(const double* A, Index rows, Index columns, const double* x, const double* y, double* out_x,
                  double* out_y);
void node_sums(const double* columns, const double* x, Index count, const double* start, double* out);
void matrix8(const double* A, const double* x, double* out);

bool solve_stribeck(const Trial& trial);
void solve_stick(const Trial& trial, const double* inverse);
void solve_sliding(const Trial& trial);
bool solve_nodes(const double* A, const double* d, const double* r, double* out_delta);
void two_dots(const double* a, const double* b, const double* x, double& out_a, double& out_b);
double speed_guard(const double* bernstein, const double* by_start, double start, double sign, const double* drive,
                   const double* velocity, double* out);
double force_guard(const double* bernstein, const double* forces, double* out);
void propagate(const StepArrays& step, const double* x, const double* forces, double* out_x);
double loss(const LossArrays& form, const double* x, const double* forces);
void taylor(const PairArrays& pairs, const double* x, const double* coefficient, double tau, int terms, double* out_x);
Work taylor_work(const PairArrays& pairs, const double* velocity_row, const double* damping, const double* x,
                 const double* coefficient, double tau, int terms, const SeriesRule& rule, double* out_moments,
                 double* out_x);

void free_motion(const MotionArrays& pairs, double t, const double* free, double* x);
void changes(const MotionArrays& pairs, const double* times, Index count, double* out);
void caused(Index np, Index points, const double* a, const double* b, const double* u, const double* v, const double* w,
            double* out);
void weighted_products(Index np, const double* A, const double* B, const double* weight, double* out);
void pass(const ChangeArrays& change, double* x, double* free, double* out_size);

extern const Kernels kSet;

}  // namespace SLIPMODE_KERNEL_SET
}  // namespace slipmode::kernels
