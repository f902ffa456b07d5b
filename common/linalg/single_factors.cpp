// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/single_factors.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet {

struct SingleFactors::Analysis {
  cholmod_common common;
  cholmod_factor* symbolic = nullptr;
  Analysis() {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
    common.print = 0;
    // Supernodes that are a little too wide read zeros, those that are too thin little at once.
    common.nrelax[0] = 2;
    common.zrelax[0] = 0.3;
    common.zrelax[1] = common.zrelax[2] = 0.05;
  }
  ~Analysis() {
    cholmod_free_factor(&symbolic, &common);
    cholmod_finish(&common);
  }
  Analysis(const Analysis&) = delete;
  Analysis& operator=(const Analysis&) = delete;
};

SingleFactors::SingleFactors() = default;
SingleFactors::~SingleFactors() = default;

void SingleFactors::factorise(std::span<const int> offset, std::span<const int> index,
                              std::span<const double> value) {
  const std::size_t n = offset.size() - 1;
  cholmod_sparse a{};
  a.nrow = a.ncol = n;
  a.nzmax = index.size();
  a.p = const_cast<int*>(offset.data());
  a.i = const_cast<int*>(index.data());
  a.x = const_cast<double*>(value.data());
  a.stype = 1;  // only the upper triangle is read
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_REAL;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = 1;
  a.packed = 1;
  if (!analysis_) {
    analysis_ = std::make_unique<Analysis>();
    analysis_->symbolic = cholmod_analyze(&a, &analysis_->common);
  }
  cholmod_common& common = analysis_->common;
  cholmod_factor* factor = analysis_->symbolic ? cholmod_copy_factor(analysis_->symbolic, &common) : nullptr;
  const bool done = factor && cholmod_factorize(&a, factor, &common) && common.status == CHOLMOD_OK &&
                    factor->minor >= n && factor->is_super;
  if (done) keep(*factor);
  cholmod_free_factor(&factor, &common);
  if (!done)
    throw SolveFailure("A matrix of {} rows that should be positive definite has no Cholesky factors.", n);
}

void SingleFactors::keep(const cholmod_factor& factor) {
  const auto* first = static_cast<const int*>(factor.super);
  const auto* first_row = static_cast<const int*>(factor.pi);
  const auto* first_value = static_cast<const int*>(factor.px);
  const auto* rows = static_cast<const int*>(factor.s);
  const auto* permutation = static_cast<const int*>(factor.Perm);
  order_.assign(permutation, permutation + factor.n);
  work_.assign(factor.n + 1, 0.0F);
  nodes_.clear();
  row_.clear();
  triangle_.clear();
  below_.clear();
  Index most = 0;
  for (std::size_t s = 0; s < factor.nsuper; ++s) {
    const Index columns = first[s + 1] - first[s], all = first_row[s + 1] - first_row[s];
    const Index groups = (all - columns + lanes - 1) / lanes;
    nodes_.push_back({first[s], columns, groups, triangle_.size(), row_.size(), below_.size()});
    row_.insert(row_.end(), rows + first_row[s] + columns, rows + first_row[s] + all);
    row_.resize(nodes_.back().rows + std::size_t(groups) * lanes, static_cast<Index>(factor.n));
    keep(nodes_.back(), static_cast<const double*>(factor.x) + first_value[s], all);
    most = std::max(most, columns);
  }
  sum_.resize(most);
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
      Lanes part{};
      for (int l = 0; l < lanes; ++l) {
        const std::size_t i = n + std::size_t(g) * lanes + l;
        if (i < stride) part[l] = static_cast<float>(block[i + j * stride]);
      }
      below_.push_back(part);
    }
}

/// The columns' own x, by the inverse of their triangle: no row waits for the one before.
void SingleFactors::multiply_inverse(const Supernode& node) {
  const float* l = triangle_.data() + node.triangle + std::size_t(node.columns) * (node.columns + 1) / 2;
  float* x = work_.data() + node.first;
  for (Index i = node.columns - 1; i >= 0; --i) {
    l -= i + 1;
    float value = 0;
    for (Index j = 0; j <= i; ++j) value += l[j] * x[j];
    x[i] = value;
  }
}

void SingleFactors::multiply_transposed(const Supernode& node) {
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
void SingleFactors::spread(const Supernode& node) {
  const Index columns = Columns > 0 ? Columns : node.columns;
  const float* x = work_.data() + node.first;
  const Lanes* l = below_.data() + node.below;
  const Index* row = row_.data() + node.rows;
  for (Index g = 0; g < node.groups; ++g, row += lanes, l += columns) {
    Lanes part{};
    for (Index j = 0; j < columns; ++j) part += l[j] * x[j];
    for (int k = 0; k < lanes; ++k) work_[row[k]] -= part[k];
  }
}

/// x -= L^T (rows below).
template <int Columns>
void SingleFactors::collect(const Supernode& node) {
  const Index columns = Columns > 0 ? Columns : node.columns;
  float* x = work_.data() + node.first;
  const Lanes* l = below_.data() + node.below;
  const Index* row = row_.data() + node.rows;
  Lanes few[Columns > 0 ? Columns : 1];
  Lanes* sum = Columns > 0 ? few : sum_.data();
  std::fill_n(sum, columns, Lanes{});
  for (Index g = 0; g < node.groups; ++g, row += lanes, l += columns) {
    const Lanes part{work_[row[0]], work_[row[1]], work_[row[2]], work_[row[3]]};
    for (Index j = 0; j < columns; ++j) sum[j] += l[j] * part;
  }
  for (Index j = 0; j < columns; ++j) x[j] -= (sum[j][0] + sum[j][1]) + (sum[j][2] + sum[j][3]);
}

void SingleFactors::forward(const Supernode& node) {
  multiply_inverse(node);
  switch (node.columns) {
    case 1:
      return spread<1>(node);
    case 2:
      return spread<2>(node);
    case 3:
      return spread<3>(node);
    case 4:
      return spread<4>(node);
    case 5:
      return spread<5>(node);
    case 6:
      return spread<6>(node);
    default:
      return spread<0>(node);
  }
}

void SingleFactors::backward(const Supernode& node) {
  switch (node.columns) {
    case 1:
      collect<1>(node);
      break;
    case 2:
      collect<2>(node);
      break;
    case 3:
      collect<3>(node);
      break;
    case 4:
      collect<4>(node);
      break;
    case 5:
      collect<5>(node);
      break;
    case 6:
      collect<6>(node);
      break;
    default:
      collect<0>(node);
  }
  multiply_transposed(node);
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
  for (const Supernode& node : nodes_) forward(node);
  work_.back() = 0;
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) backward(*node);
  for (std::size_t i = 0; i < order_.size(); ++i) x[order_[i]] = largest * work_[i];
}

}  // namespace couplet
