// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output/output.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {

template <int D>
PointValues<D>::PointValues(const Fluid<D>& fluid, const mesh::Geometry& geometry)
    : fluid_(fluid),
      interpolation_(fluid.mesh(), geometry,
                     std::vector<fv::PatchStencil>(fluid.mesh().patches.size(), fv::PatchStencil::open)) {}

template <int D>
void PointValues<D>::follow() {
  const State<D>& s = fluid_.state();
  if (fluid_.moving()) interpolation_.update(mesh::compute_geometry(fluid_.mesh(), s.points));
}

template <int D>
void PointValues<D>::fill(const Quantities<D>& quantities, std::span<const io::Probe> probes,
                          std::span<double> values) const {
  const mesh::Mesh& mesh = fluid_.mesh();
  const int width = quantities.width();
  int first = 0;
  for (const Quantity& q : quantities.all()) {
    std::vector<double> boundary(q.boundary.begin(), q.boundary.end());
    boundary.resize(std::size_t(mesh.boundary.n_local()) * q.components, 0.0);
    mesh.boundary.update_ghosts(boundary, q.components);
    for (const io::Probe& probe : probes)
      for (const Index point : probe.points()) {
        double* at = values.data() + std::size_t(point) * width + first;
        if (q.components == D) {
          const Vec<D> value = interpolation_.template scalar_at<D>(point, q.cells, boundary);
          std::copy_n(value.data(), D, at);
        } else {
          *at = interpolation_.template scalar_at<1>(point, q.cells, boundary)[0];
        }
      }
    first += q.components;
  }
}

Sample::Sample(const mesh::Mesh& mesh, std::span<const Vec3> places, std::string name,
               const SampleParameters& p)
    : name_(std::move(name)) {
  const int rows = p.type == SampleParameters::Type::plane ? p.rows : 1;
  const io::PlaceSearch search(mesh, places);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < p.points; ++i) {
      const double s = double(i) / (p.points - 1), r = rows > 1 ? double(j) / (rows - 1) : 0.0;
      auto probe = io::Probe::in(search, p.from + s * (p.to - p.from) + r * (p.up - p.from));
      if (!probe) continue;  // on all ranks
      probes_.push_back(*std::move(probe));
      along_.push_back({s, r});
    }
  if (probes_.empty()) try {
      io::Probe(mesh, places, name_, p.from);
    } catch (const Error& outside) {
      throw Error("output.samples.{}: none of its points is in the mesh. {}", name_, outside.what());
    }
  const auto asked = std::size_t(p.points) * std::size_t(rows);
  if (probes_.size() < asked && parallel::comm_rank(mesh.comm) == 0)
    log::info("output.samples.{}: {} of {} points are outside the mesh and are omitted", name_,
              asked - probes_.size(), asked);
}

std::vector<double> Sample::gather(MPI_Comm comm, std::span<const double> at_points, int components) const {
  std::vector<double> values(probes_.size() * components, 0.0);
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    const io::Probe& probe = probes_[k];
    for (std::size_t i = 0; i < probe.points().size(); ++i)
      for (int c = 0; c < components; ++c)
        values[k * components + c] +=
            probe.weights()[i] * at_points[std::size_t(probe.points()[i]) * components + c];
  }
  const bool root = parallel::comm_rank(comm) == 0;  // all ranks but one bring zeros
  MPI_Reduce(root ? MPI_IN_PLACE : values.data(), values.data(), static_cast<int>(values.size()), MPI_DOUBLE,
             MPI_SUM, 0, comm);
  if (!root) values.clear();
  return values;
}

template class PointValues<2>;
template class PointValues<3>;

}  // namespace couplet::fluid
