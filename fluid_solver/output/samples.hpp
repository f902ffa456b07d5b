// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "common/fv/vertex_interpolation.hpp"
#include "common/io/probes/probe.hpp"
#include "fluid_solver/output/derived.hpp"

namespace couplet::fluid {

/// Values at mesh points from those in the cells and at the boundary, on the mesh as it is: what probes and
/// samples are made of.
template <int D>
class PointValues {
 public:
  /// `geometry`: of the mesh at rest, looked at while this is made.
  PointValues(const Fluid<D>& fluid, const mesh::Geometry& geometry);
  /// To be called when the mesh may have moved, before fill(). Collective.
  void follow();
  /// Sets `values`, width() a local point, at the points of the probes; the others are left alone. Collective.
  void fill(const Quantities<D>& quantities, std::span<const io::Probe> probes,
            std::span<double> values) const;

 private:
  const Fluid<D>& fluid_;
  fv::VertexInterpolation interpolation_;
};

/// The places of a line or plane that lie in the mesh.
class Sample {
 public:
  /// `places`: of the local points [m]. Throws Error if none does. Collective.
  Sample(const mesh::Mesh& mesh, std::span<const Vec3> places, std::string name,
         const SampleParameters& parameters);
  const std::string& name() const { return name_; }
  const std::vector<io::Probe>& probes() const { return probes_; }
  /// Position of each probe along from-to and from-up, 0 to 1.
  const std::vector<std::array<double, 2>>& along() const { return along_; }
  /// Values at each probe from those at local points, `components` each, on rank 0; empty elsewhere. Collective.
  std::vector<double> gather(MPI_Comm comm, std::span<const double> at_points, int components) const;

 private:
  std::string name_;
  std::vector<io::Probe> probes_;
  std::vector<std::array<double, 2>> along_;
};

}  // namespace couplet::fluid
