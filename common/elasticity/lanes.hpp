// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>

// Vector values are passed only between inlined functions, so no ABI is involved.
#pragma GCC diagnostic ignored "-Wpsabi"

/// Short vectors for loops over packed fields: the components of a node, padded to a power of two (2 in 2-D,
/// 4 in 3-D). They use the vector extension of GCC and Clang, with one or several registers depending on the
/// processor.
namespace couplet::elastic::lanes {

template <int Width>
struct OfWidth {
  using type [[gnu::vector_size(sizeof(double) * Width)]] = double;
};
template <int D>
constexpr int width = D == 2 ? 2 : 4;
template <int D>
using Lane = typename OfWidth<width<D>>::type;

template <int D>
[[gnu::always_inline]] inline Lane<D> load(const double* from) {
  Lane<D> value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

template <int D>
[[gnu::always_inline]] inline void store(double* to, const Lane<D>& value) {
  std::memcpy(to, &value, sizeof value);
}

template <int D>
[[gnu::always_inline]] inline void add(double* to, const Lane<D>& value) {
  store<D>(to, load<D>(to) + value);
}

/// Dot product of the D components, without the padding.
template <int D>
[[gnu::always_inline]] inline double dot(const Lane<D>& a, const Lane<D>& b) {
  const Lane<D> product = a * b;
  if constexpr (D == 2)
    return product[0] + product[1];
  else
    return product[0] + product[1] + product[2];
}

/// Cross product in 3-D. The padding becomes zero if it is finite.
[[gnu::always_inline]] inline Lane<3> cross(const Lane<3>& a, const Lane<3>& b) {
  const Lane<3> turned =
      a * __builtin_shufflevector(b, b, 1, 2, 0, 3) - __builtin_shufflevector(a, a, 1, 2, 0, 3) * b;
  return __builtin_shufflevector(turned, turned, 1, 2, 0, 3);
}

}  // namespace couplet::elastic::lanes

namespace couplet::elastic {

/// Values at four locations.
using Four = lanes::Lane<3>;

}  // namespace couplet::elastic
