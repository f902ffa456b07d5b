// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/motion/share.hpp"

#include <numbers>

#include "common/base/error.hpp"
#include "common/mesh/load.hpp"

namespace couplet::plate {
namespace {

std::vector<int> shares(MPI_Comm comm, std::size_t n) {
  const int ranks = parallel::comm_size(comm);
  std::vector<int> counts;
  for (int r = 0; r < ranks; ++r) counts.push_back(int(n * (r + 1) / ranks - n * r / ranks));
  return counts;
}

std::vector<int> scaled(const std::vector<int>& counts, int width) {
  std::vector<int> result;
  for (const int n : counts) result.push_back(n * width);
  return result;
}

std::vector<int> starts(const std::vector<int>& counts) {
  std::vector<int> result;
  int at = 0;
  for (const int n : counts) result.push_back(at), at += n;
  return result;
}

/// This rank's rows, each of `width` values, of rank 0's table.
std::vector<double> scatter(MPI_Comm comm, const std::vector<int>& counts, int width, const double* on_root) {
  const std::vector<int> n = scaled(counts, width), first = starts(n);
  std::vector<double> here(n[parallel::comm_rank(comm)]);
  MPI_Scatterv(on_root, n.data(), first.data(), MPI_DOUBLE, here.data(), int(here.size()), MPI_DOUBLE, 0,
               comm);
  return here;
}

std::vector<Vec3> vectors(const std::vector<double>& flat) {
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < flat.size(); i += 3) result.emplace_back(&flat[i]);
  return result;
}

const double* flat_data(const std::vector<Vec3>& values) {
  return values.empty() ? nullptr : values.front().data();
}

}  // namespace

Share::Share(MPI_Comm comm, const modes::ModalModel& whole)
    : comm_(comm), omega_(whole.frequency), participation_(whole.participation), mass_(whole.mass) {
  std::vector<double> sizes{double(whole.faces.size()), double(whole.vertices.size()), whole.mass};
  mesh::broadcast(comm, sizes);
  mesh::broadcast(comm, omega_);
  for (double& omega : omega_) omega *= 2 * std::numbers::pi;
  mesh::broadcast(comm, participation_);
  mass_ = sizes[2];
  face_counts_ = shares(comm, std::size_t(sizes[0]));
  vertex_counts_ = shares(comm, std::size_t(sizes[1]));
  interface_.dim = 3;
  if (parallel::comm_rank(comm) == 0) {
    interface_.vertices = whole.vertices;
    interface_.face_centres = modes::face_centres(whole);
    interface_.face_areas = modes::face_areas(whole);
    interface_.face_offset = whole.faces.offset;
    interface_.face_vertices = whole.faces.index;
  }
  const int width = 3 * n_modes();
  centres_ = vectors(scatter(comm, face_counts_, 3, flat_data(interface_.face_centres)));
  areas_ = vectors(scatter(comm, face_counts_, 3, flat_data(interface_.face_areas)));
  face_shape_ = scatter(comm, face_counts_, width, whole.face_shape.data());
  vertex_shape_ = scatter(comm, vertex_counts_, width, whole.vertex_shape.data());
}

std::vector<double> Share::participation(const Vec3& direction) const {
  std::vector<double> result(omega_.size());
  for (std::size_t m = 0; m < omega_.size(); ++m)
    for (int c = 0; c < 3; ++c)
      result[m] += direction[c] * participation_[std::size_t(c) * omega_.size() + m];
  return result;
}

// The midpoint rule of thesis 4.5.1: the force of a face on the mode at the face.
void Share::add_load(std::span<const double> force, std::span<double> load) const {
  const std::size_t n = omega_.size();
  for (std::size_t i = 0; i < 3 * centres_.size(); ++i) {
    if (force[i] == 0) continue;
    const double* shape = face_shape_.data() + i * n;
    for (std::size_t m = 0; m < n; ++m) load[m] += force[i] * shape[m];
  }
}

std::vector<double> Share::scatter_faces(const std::vector<double>& on_root) const {
  const std::size_t n = interface_.face_centres.size();
  const std::vector<double> zeros(on_root.empty() && parallel::comm_rank(comm_) == 0 ? 3 * n : 0);
  const std::vector<double>& values = zeros.empty() ? on_root : zeros;
  if (parallel::comm_rank(comm_) == 0 && values.size() != 3 * n)
    throw Error("The structure received {} force values, but its surface has {} faces with 3 components.",
                values.size(), n);
  return scatter(comm_, face_counts_, 3, values.data());
}

std::vector<double> Share::gather_vertices(std::span<const double> q) const {
  const std::size_t n = omega_.size();
  std::vector<double> here(vertex_shape_.size() / n);
  for (std::size_t i = 0; i < here.size(); ++i) {
    const double* shape = vertex_shape_.data() + i * n;
    double value = 0;
    for (std::size_t m = 0; m < n; ++m) value += shape[m] * q[m];
    here[i] = value;
  }
  const std::vector<int> counts = scaled(vertex_counts_, 3), first = starts(counts);
  std::vector<double> all(3 * interface_.vertices.size());
  MPI_Gatherv(here.data(), int(here.size()), MPI_DOUBLE, all.data(), counts.data(), first.data(), MPI_DOUBLE,
              0, comm_);
  return all;
}

void Share::sum(std::span<double> values) const {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), int(values.size()), MPI_DOUBLE, MPI_SUM, comm_);
}

}  // namespace couplet::plate
