// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundary/rigid_patches.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>

#include "common/elasticity/vector_at.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/boundary/loads.hpp"

namespace couplet::solid {
namespace {

// Smallest over largest moment of inertia of faces that are not collinear.
constexpr double on_a_line = 1e-10;
constexpr std::size_t motions = 6;

}  // namespace

RigidPatches::RigidPatches(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic,
                           const std::vector<std::vector<Index>>& faces)
    : mesh_(&mesh) {
  const mesh::Geometry& geometry = elastic.geometry();
  const std::vector<Index>& unknown = elastic.unknown_faces();
  for (const std::vector<Index>& of_patch : faces) {
    Patch patch;
    for (const Index f : of_patch) {
      const auto found = std::ranges::lower_bound(unknown, f);
      patch.node.push_back(std::size_t(mesh.cells.n_owned()) + std::size_t(found - unknown.begin()));
      patch.arm.push_back(geometry.face_centre[f]);
    }
    make(patch);
    patches_.push_back(std::move(patch));
  }
}

void RigidPatches::make(Patch& patch) const {
  const MPI_Comm comm = mesh_->comm;
  patch.share = 1 / parallel::sum(comm, double(patch.node.size()));
  Vec3 total = Vec3::Zero();
  for (const Vec3& x : patch.arm) total += x;
  const Vec3 centre = sum_of(comm, total) * patch.share;
  Tensor3 inertia = Tensor3::Zero();
  for (Vec3& r : patch.arm) {
    r -= centre;
    inertia += r.squaredNorm() * Tensor3::Identity() - r * r.transpose();
  }
  inertia = sum_of(comm, inertia);
  if (mesh_->dim == 2) {  // about z alone
    if (inertia(2, 2) > 0) patch.spin(2, 2) = 1 / inertia(2, 2);
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Tensor3> axes(inertia);
  for (int k = 0; k < 3; ++k)
    if (axes.eigenvalues()[k] > on_a_line * axes.eigenvalues()[2])
      patch.spin +=
          axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose() / axes.eigenvalues()[k];
}

void RigidPatches::project(std::span<double> unknowns) const {
  if (patches_.empty()) return;
  const int dim = mesh_->dim;
  std::vector<double> sums(motions * patches_.size(), 0);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    Vec3 total = Vec3::Zero(), moment = Vec3::Zero();
    for (std::size_t i = 0; i < patches_[p].node.size(); ++i) {
      const Vec3 v = elastic::vector_at(unknowns, Index(patches_[p].node[i]), dim);
      total += v;
      moment += patches_[p].arm[i].cross(v);
    }
    std::copy_n(total.data(), 3, &sums[motions * p]);
    std::copy_n(moment.data(), 3, &sums[motions * p + 3]);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_->comm);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const Patch& patch = patches_[p];
    const Vec3 shift = patch.share * Vec3(sums[motions * p], sums[motions * p + 1], sums[motions * p + 2]);
    const Vec3 turn = patch.spin * Vec3(sums[motions * p + 3], sums[motions * p + 4], sums[motions * p + 5]);
    for (std::size_t i = 0; i < patch.node.size(); ++i) {
      const Vec3 v = shift + turn.cross(patch.arm[i]);
      for (int a = 0; a < dim; ++a) unknowns[patch.node[i] * std::size_t(dim) + std::size_t(a)] = v[a];
    }
  }
}

}  // namespace couplet::solid
