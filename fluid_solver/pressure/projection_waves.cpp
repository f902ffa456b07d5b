// SPDX-License-Identifier: Apache-2.0
// What pressure waves, and walls that yield, change in the pressure equation.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/parallel/collective.hpp"
#include "fluid_solver/pressure/projection.hpp"

namespace couplet::fluid {
namespace {

/// Largest extent of the mesh [m]. Collective.
double size_of(const mesh::Mesh& mesh, std::span<const Vec3> points) {
  constexpr double far = std::numeric_limits<double>::max();
  double size = 0;
  for (int c = 0; c < mesh.dim; ++c) {
    double low = far, high = -far;
    for (const Vec3& x : points) low = std::min(low, x[c]), high = std::max(high, x[c]);
    size = std::max(size, parallel::max(mesh.comm, high) - parallel::min(mesh.comm, low));
  }
  return size;
}

}  // namespace

template <int D>
void PressureProjection<D>::make_waves() {
  compression_ = std::make_unique<Compression<D>>(k_);
  if (!k_.boundary.absorbing_patches().empty())
    absorbing_ = std::make_unique<AbsorbingBoundaries<D>>(k_, size_of(k_.mesh, k_.points_at_rest));
  if (!k_.boundary.upstream_patches().empty()) upstream_ = std::make_unique<UpstreamVolume<D>>(k_);
}

template <int D>
void PressureProjection<D>::set_waves(const State<D>& from) {
  compression_->prepare(from);
  if (absorbing_) absorbing_->prepare(from);
  if (upstream_) upstream_->prepare(from, compression_->rate());
}

/// Per boundary face [m]; empty: nothing answers to the pressure.
template <int D>
std::vector<double> PressureProjection<D>::admittance() const {
  if (!walls_ && !absorbing_) return {};
  std::vector<double> values(k_.w.size(), 0.);
  if (absorbing_) absorbing_->add_admittance(values);
  if (walls_) walls_->respond(values);
  return values;
}

template <int D>
std::span<const double> PressureProjection<D>::storage() const {
  return stores() ? std::span<const double>(compression_->storage()) : std::span<const double>{};
}

/// What the matrix knows of the step.
template <int D>
std::array<double, 3> PressureProjection<D>::matrix_rule() const {
  if (!compression_) return {};
  return {compression_->rate(), k_.step.dt, absorbing_ ? absorbing_->weight() : 0};
}

/// Onto b, whose size less what holds the pressure as it was is given back. Collective.
template <int D>
double PressureProjection<D>::add_waves() {
  if (absorbing_) absorbing_->add_to(b_);
  double changed = compression_->add_to(b_);
  // Of a fluid at rest the volume's pressure may be all that there is.
  if (upstream_) changed = std::hypot(changed, upstream_->add_to(b_));
  return stores() ? changed : -1;
}

template <int D>
void PressureProjection<D>::accept() {
  pressure_.accept();
  if (upstream_) upstream_->accept();
}

template <int D>
void PressureProjection<D>::save(io::CheckpointWriter& file) const {
  pressure_.save(file);
  if (upstream_) upstream_->save(file);
}

template <int D>
void PressureProjection<D>::load(io::CheckpointReader& file) {
  pressure_.load(file);
  if (upstream_) upstream_->load(file);
}

template void PressureProjection<2>::make_waves();
template void PressureProjection<2>::set_waves(const State<2>&);
template std::vector<double> PressureProjection<2>::admittance() const;
template std::span<const double> PressureProjection<2>::storage() const;
template double PressureProjection<2>::add_waves();
template std::array<double, 3> PressureProjection<2>::matrix_rule() const;
template void PressureProjection<2>::accept();
template void PressureProjection<2>::save(io::CheckpointWriter&) const;
template void PressureProjection<2>::load(io::CheckpointReader&);
template void PressureProjection<3>::make_waves();
template void PressureProjection<3>::set_waves(const State<3>&);
template std::vector<double> PressureProjection<3>::admittance() const;
template std::span<const double> PressureProjection<3>::storage() const;
template double PressureProjection<3>::add_waves();
template std::array<double, 3> PressureProjection<3>::matrix_rule() const;
template void PressureProjection<3>::accept();
template void PressureProjection<3>::save(io::CheckpointWriter&) const;
template void PressureProjection<3>::load(io::CheckpointReader&);

}  // namespace couplet::fluid
