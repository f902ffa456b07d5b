// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <span>
#include <type_traits>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::linalg {

/// Numbers that are done together.
constexpr Index slice_width = 8;
/// Two halves, each a register of AVX2: of wider vectors than the processor has GCC 12 makes detours through memory.
struct EightDoubles {
  using Half [[gnu::vector_size(32)]] = double;
  Half low, high;
  double operator[](int k) const { return k < 4 ? low[k] : high[k - 4]; }
};
using EightFloats [[gnu::vector_size(32)]] = float;
template <class Number>
using Eight = std::conditional_t<std::is_same_v<Number, double>, EightDoubles, EightFloats>;

[[gnu::always_inline]] inline EightDoubles operator+(const EightDoubles& a, const EightDoubles& b) {
  return {a.low + b.low, a.high + b.high};
}
[[gnu::always_inline]] inline EightDoubles operator-(const EightDoubles& a, const EightDoubles& b) {
  return {a.low - b.low, a.high - b.high};
}
[[gnu::always_inline]] inline EightDoubles operator*(const EightDoubles& a, const EightDoubles& b) {
  return {a.low * b.low, a.high * b.high};
}
[[gnu::always_inline]] inline EightDoubles operator*(double a, const EightDoubles& b) {
  return {a * b.low, a * b.high};
}
[[gnu::always_inline]] inline void operator+=(EightDoubles& a, const EightDoubles& b) {
  a.low += b.low, a.high += b.high;
}

[[gnu::always_inline]] inline void load(const double* from, EightDoubles& v) {
  std::memcpy(&v.low, from, sizeof(v.low)), std::memcpy(&v.high, from + 4, sizeof(v.high));
}
[[gnu::always_inline]] inline void load(const float* from, EightFloats& v) {
  std::memcpy(&v, from, sizeof(v));
}
[[gnu::always_inline]] inline void store(const EightDoubles& v, double* to) {
  std::memcpy(to, &v.low, sizeof(v.low)), std::memcpy(to + 4, &v.high, sizeof(v.high));
}
[[gnu::always_inline]] inline void store(const EightFloats& v, float* to) { std::memcpy(to, &v, sizeof(v)); }
[[gnu::always_inline]] inline void load(const double* x, const Index* at, EightDoubles& v) {
  v.low = EightDoubles::Half{x[at[0]], x[at[1]], x[at[2]], x[at[3]]};
  v.high = EightDoubles::Half{x[at[4]], x[at[5]], x[at[6]], x[at[7]]};
}
[[gnu::always_inline]] inline void load(const float* x, const Index* at, EightFloats& v) {
  v = EightFloats{x[at[0]], x[at[1]], x[at[2]], x[at[3]], x[at[4]], x[at[5]], x[at[6]], x[at[7]]};
}
template <class Number>
[[gnu::always_inline]] inline Number sum_of(const Eight<Number>& v) {
  return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
}
/// Entries that an array has room for, so that eight may be read or written at any of n.
constexpr std::size_t with_room(std::size_t n) { return n + 2 * slice_width; }

/// Entries of sparse rows, eight rows a slice, column by column. Where eight rows have their neighbours side by side, as cells of
/// structured parts have, a column knows the first alone and reads them at once; else it has eight places.
template <class Number>
struct Slices {
  struct Entry {
    Index row, column, slot;  ///< places of both, and any number of the caller's
  };
  std::vector<std::uint32_t> start{0};  ///< of each slice: its columns
  std::vector<Index>
      place;  ///< of each column: the first of its places; below 0: -1 - (first of eight in `apart`)
  std::vector<Index> apart;
  std::vector<Number> value;  ///< eight a column, 0 where a row has none

  Index size() const { return static_cast<Index>(start.size()) - 1; }
  /// The next eight rows, from `first` on. `entries`: theirs; `room`: of the arrays that will be read. `put(slot, k)`: told where in
  /// `value` each entry is.
  template <class Put>
  void add(Index first, std::vector<Entry>& entries, Index room, const Put& put);

  /// sum += a x of slice s.
  [[gnu::always_inline]] inline void multiply(Index s, const Number* x, Eight<Number>& sum) const {
    const Number* v = value.data() + std::size_t(start[s]) * slice_width;
    for (std::uint32_t k = start[s]; k < start[s + 1]; ++k, v += slice_width) {
      Eight<Number> a{}, b{};
      load(v, a);
      if (place[k] >= 0) {
        load(x + place[k], b);
      } else {
        load(x, apart.data() + (-1 - place[k]), b);
      }
      sum += a * b;
    }
  }
};

template <class Number>
template <class Put>
void Slices<Number>::add(Index first, std::vector<Entry>& entries, Index room, const Put& put) {
  // A column of neighbours side by side pays from four rows on.
  constexpr std::ptrdiff_t enough = 4;
  const auto ahead = [](const Entry& e) { return e.column - e.row; };
  std::ranges::sort(entries, {}, [&](const Entry& e) { return std::array{ahead(e), e.row, e.slot}; });
  const auto new_column = [&](Index at) {
    place.push_back(at);
    value.resize(value.size() + slice_width, Number(0));
    return value.size() - slice_width;
  };
  const auto set = [&](const Entry& e, std::size_t column) {
    put(e.slot, column + std::size_t(e.row - first));
  };
  std::vector<Entry> left;
  for (auto from = entries.begin(), to = from; from != entries.end(); from = to) {
    while (to != entries.end() && ahead(*to) == ahead(*from) && (to == from || to->row != std::prev(to)->row))
      ++to;
    const Index at = first + ahead(*from);
    if (to - from < enough || at < 0 || at + slice_width > room) {
      left.insert(left.end(), from, to);
      continue;
    }
    const std::size_t column = new_column(at);
    for (auto e = from; e != to; ++e) set(*e, column);
  }
  Index taken[slice_width] = {};
  std::vector<std::size_t> columns;
  for (const Entry& e : left) {
    const auto k = static_cast<std::size_t>(taken[e.row - first]++);
    if (k == columns.size()) {
      columns.push_back(new_column(-1 - static_cast<Index>(apart.size())));
      apart.resize(apart.size() + slice_width, 0);
    }
    set(e, columns[k]);
    apart[std::size_t(-1 - place[columns[k] / slice_width]) + std::size_t(e.row - first)] = e.column;
  }
  start.push_back(static_cast<std::uint32_t>(place.size()));
}

}  // namespace couplet::linalg
