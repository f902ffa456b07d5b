// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/single_factors.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/processor_clones.hpp"

namespace couplet::linalg {

namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

// Supernodes that are a little too wide read zeros, those that are too thin little at once: up to so many
// columns they take any zeros, up to so many this part, beyond that.
constexpr Index always = 2, narrow = 16;
constexpr double zeros_of_narrow = 0.3, zeros_of_wide = 0.05;

bool worth_its_zeros(Index columns, double zeros, double entries) {
  return columns <= always || zeros <= (columns <= narrow ? zeros_of_narrow : zeros_of_wide) * entries;
}

}  // namespace

struct SingleFactors::Analysis {
  Eigen::SimplicialLLT<Matrix, Eigen::Upper, Eigen::AMDOrdering<int>> solver;
  const Matrix& factor() const { return solver.matrixL().nestedExpression(); }
};

SingleFactors::SingleFactors() = default;
SingleFactors::~SingleFactors() = default;

void SingleFactors::factorise(std::span<const int> offset, std::span<const int> index,
                              std::span<const double> value) {
  const int n = static_cast<int>(offset.size()) - 1;
  const Eigen::Map<const Matrix> a(n, n, static_cast<int>(index.size()), offset.data(), index.data(),
                                   value.data());
  const bool first = !analysis_;
  if (first) {
    analysis_ = std::make_unique<Analysis>();
    analysis_->solver.analyzePattern(a);
  }
  analysis_->solver.factorize(a);
  if (analysis_->solver.info() != Eigen::Success)
    throw SolveFailure("Cholesky factorisation failed: a matrix of {} rows is not positive definite.", n);
  if (first) find_supernodes();
  keep_values();
}

/// A column joins the ones before it if it is their parent in the elimination tree: their rows are then among
/// its own.
void SingleFactors::find_supernodes() {
  const Matrix& l = analysis_->factor();
  const int *start = l.outerIndexPtr(), *row = l.innerIndexPtr();
  const auto n = static_cast<Index>(l.cols());
  order_.resize(n);
  const auto& place = analysis_->solver.permutationP().indices();
  for (Index i = 0; i < n; ++i) order_[place[i]] = i;
  work_.assign(std::size_t(n) + 1, 0.0F);
  Index most = 0;
  std::size_t n_below = 0, n_triangle = 0;
  for (Index first = 0, next = 0; first < n; first = next) {
    double entries = start[first + 1] - start[first];
    for (next = first + 1; next < n; ++next) {
      if (start[next] - start[next - 1] < 2 || row[start[next - 1] + 1] != next) break;
      const double columns = next + 1 - first, below = start[next + 1] - start[next] - 1;
      const double filled = columns * (columns + 1) / 2 + columns * below;
      entries += below + 1;
      if (!worth_its_zeros(next + 1 - first, filled - entries, filled)) break;
    }
    const Index columns = next - first, below = start[next] - start[next - 1] - 1;
    const Index groups = (below + lanes - 1) / lanes;
    nodes_.push_back({first, columns, groups, n_triangle, row_.size(), n_below});
    row_.insert(row_.end(), row + start[next] - below, row + start[next]);
    row_.resize(nodes_.back().rows + std::size_t(groups) * lanes, n);
    n_triangle += std::size_t(columns) * (columns + 1) / 2;
    n_below += std::size_t(groups) * columns * lanes;
    most = std::max(most, columns);
  }
  sum_.resize(std::size_t(most) * lanes);
  triangle_.reserve(n_triangle);
  below_.reserve(n_below);
}

void SingleFactors::keep_values() {
  const Matrix& l = analysis_->factor();
  const int *start = l.outerIndexPtr(), *row = l.innerIndexPtr();
  std::vector<double> block;
  triangle_.clear();
  below_.clear();
  for (const Supernode& node : nodes_) {
    const Index last = node.first + node.columns - 1;
    const std::size_t stride = node.columns + start[last + 1] - start[last] - 1;
    block.assign(stride * node.columns, 0.0);
    for (Index j = 0; j < node.columns; ++j) {
      double* column = block.data() + std::size_t(j) * stride;
      const Index* below = row_.data() + node.rows;
      for (int k = start[node.first + j]; k < start[node.first + j + 1]; ++k) {
        if (row[k] <= last) {
          column[row[k] - node.first] = l.valuePtr()[k];
          continue;
        }
        while (*below != row[k]) ++below;
        column[node.columns + (below - row_.data() - std::ptrdiff_t(node.rows))] = l.valuePtr()[k];
      }
    }
    keep(node, block.data(), stride);
  }
}

/// `block`: the columns of a supernode one after another, `stride` rows each.
void SingleFactors::keep(const Supernode& node, const double* block, std::size_t stride) {
  const std::size_t n = node.columns;
  std::vector<double> inverse(n * n, 0.0);  // of its triangle, column by column
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = j; i < n; ++i) {
      double sum = i == j ? 1 : 0;
      for (std::size_t k = j; k < i; ++k) sum -= block[i + k * stride] * inverse[k + j * n];
      inverse[i + j * n] = sum / block[i + i * stride];
    }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) triangle_.push_back(static_cast<float>(inverse[i + j * n]));
  for (Index g = 0; g < node.groups; ++g)
    for (std::size_t j = 0; j < n; ++j) {
      for (int l = 0; l < lanes; ++l) {
        const std::size_t i = n + std::size_t(g) * lanes + l;
        below_.push_back(i < stride ? static_cast<float>(block[i + j * stride]) : 0.0F);
      }
    }
}

/// The columns' own x, by the inverse of their triangle: no row waits for the one before.
[[gnu::always_inline]] inline void SingleFactors::multiply_inverse(const Supernode& node) {
  const float* l = triangle_.data() + node.triangle + std::size_t(node.columns) * (node.columns + 1) / 2;
  float* x = work_.data() + node.first;
  for (Index i = node.columns - 1; i >= 0; --i) {
    l -= i + 1;
    float value = 0;
    for (Index j = 0; j <= i; ++j) value += l[j] * x[j];
    x[i] = value;
  }
}

[[gnu::always_inline]] inline void SingleFactors::multiply_transposed(const Supernode& node) {
  const float* l = triangle_.data() + node.triangle;
  float* x = work_.data() + node.first;
  for (Index i = 0; i < node.columns; ++i) {
    const float v = x[i];
    for (Index j = 0; j < i; ++j) x[j] += l[j] * v;
    x[i] = l[i] * v;
    l += i + 1;
  }
}

/// Rows below -= L x. Columns = 0: any number.
template <int Columns>
[[gnu::always_inline]] inline void SingleFactors::spread(const Supernode& node) {
  const Index columns = Columns > 0 ? Columns : node.columns;
  const float* x = work_.data() + node.first;
  const float* l = below_.data() + node.below;
  const Index* row = row_.data() + node.rows;
  for (Index g = 0; g < node.groups; ++g, row += lanes) {
    Lanes part{}, entries;
    for (Index j = 0; j < columns; ++j, l += lanes) load(l, entries), part += entries * x[j];
    for (int k = 0; k < lanes; ++k) work_[row[k]] -= part[k];
  }
}

/// x -= L^T (rows below).
template <int Columns>
[[gnu::always_inline]] inline void SingleFactors::collect(const Supernode& node) {
  const Index columns = Columns > 0 ? Columns : node.columns;
  float* x = work_.data() + node.first;
  const float* l = below_.data() + node.below;
  const Index* row = row_.data() + node.rows;
  Lanes few[Columns > 0 ? Columns : 1] = {}, entries, sum;
  if (Columns == 0) std::fill_n(sum_.begin(), std::size_t(columns) * lanes, 0.0F);
  for (Index g = 0; g < node.groups; ++g, row += lanes) {
    Lanes part;
    load(work_.data(), row, part);
    for (Index j = 0; j < columns; ++j, l += lanes) {
      load(l, entries);
      if constexpr (Columns > 0) {
        few[j] += entries * part;
      } else {
        float* at = sum_.data() + std::size_t(j) * lanes;
        load(at, sum);
        store(Lanes(sum + entries * part), at);
      }
    }
  }
  for (Index j = 0; j < columns; ++j) {
    if constexpr (Columns == 0) load(sum_.data() + std::size_t(j) * lanes, sum);
    x[j] -= sum_of<float>(Columns > 0 ? few[Columns > 0 ? j : 0] : sum);
  }
}

/// visit.operator()<n>() with n the number of columns, 0 if there are too many to unroll.
template <class Visit>
[[gnu::always_inline]] inline void SingleFactors::with_columns(const Supernode& node, const Visit& visit) {
  switch (node.columns) {
    case 1:
      return visit.template operator()<1>();
    case 2:
      return visit.template operator()<2>();
    case 3:
      return visit.template operator()<3>();
    case 4:
      return visit.template operator()<4>();
    case 5:
      return visit.template operator()<5>();
    case 6:
      return visit.template operator()<6>();
    default:
      return visit.template operator()<0>();
  }
}

[[gnu::always_inline]] inline void SingleFactors::forward() {
  for (const Supernode& node : nodes_) {
    multiply_inverse(node);
    with_columns(node, [&]<int Columns>() [[gnu::always_inline]] { spread<Columns>(node); });
  }
}

[[gnu::always_inline]] inline void SingleFactors::backward() {
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    with_columns(*node, [&]<int Columns>() [[gnu::always_inline]] { collect<Columns>(*node); });
    multiply_transposed(*node);
  }
}

COUPLET_PROCESSOR_CLONES void forward_pass(SingleFactors& factors) { factors.forward(); }
COUPLET_PROCESSOR_CLONES void backward_pass(SingleFactors& factors) { factors.backward(); }

void SingleFactors::apply_double(std::span<const double> b, std::span<double> x) const {
  const auto n = static_cast<Eigen::Index>(b.size());
  Eigen::Map<Eigen::VectorXd>(x.data(), n) =
      analysis_->solver.solve(Eigen::Map<const Eigen::VectorXd>(b.data(), n));
}

void SingleFactors::apply(std::span<const double> b, std::span<double> x) {
  double largest = 0;
  for (const double value : b) largest = std::max(largest, std::abs(value));
  if (!(largest > 0) || !std::isfinite(largest)) {
    std::copy(b.begin(), b.end(), x.begin());
    return;
  }
  const double scale = 1 / largest;  // residuals become too small for single precision
  for (std::size_t i = 0; i < order_.size(); ++i) work_[i] = static_cast<float>(scale * b[order_[i]]);
  forward_pass(*this);
  work_.back() = 0;
  backward_pass(*this);
  for (std::size_t i = 0; i < order_.size(); ++i) x[order_[i]] = largest * work_[i];
}

}  // namespace couplet::linalg
