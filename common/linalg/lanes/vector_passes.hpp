// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

namespace couplet::linalg {

// Loops over vectors, of this rank's entries, in the instructions of the processor at hand.

double sum_of(std::span<const double> v);
/// v += by.
void shift(double by, std::span<double> v);
double sum_of_squares(std::span<const double> v);
/// z r and z q.
std::array<double, 2> two_products(std::span<const double> z, std::span<const double> r,
                                   std::span<const double> q);
/// p = z + beta p.
void turn(double beta, std::span<const double> z, std::span<double> p);
/// x += alpha p, r -= alpha q; gives r r.
double go_along(double alpha, std::span<const double> p, std::span<const double> q, std::span<double> x,
                std::span<double> r);

}  // namespace couplet::linalg
