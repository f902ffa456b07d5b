// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "common/elasticity/symmetric/space_kernel.hpp"

namespace couplet::elastic {
namespace {

/// The symmetric operator of a body of revolution: K = B^T C V B with the strains of ring_rows(), hoop strain included, and
/// the volumes of rings, so that energies, forces and masses are those of the whole body. x is the radius.
class AxisymmetricKernel final : public SpaceKernel<2> {
 public:
  AxisymmetricKernel(const mesh::Mesh& mesh, const ElasticOperator& rows) : SpaceKernel<2>(mesh, rows) {
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
      if (mesh.owner[f] >= mesh.cells.n_owned()) continue;  // another rank's
      const FaceRows face = ring_rows(mesh, rows, f);
      const LameConstants lame = face_lame(mesh, rows, f);
      Face& to = faces_.emplace_back();
      to.mu = face.volume * lame.mu;
      to.lambda = face.volume * lame.lambda;
      to.shear = face.has_shear ? to.mu : 0;
      for (std::size_t i = 0; i < 4; ++i) {
        to.place[i] = face.row[i].place;
        std::copy_n(face.row[i].b.data(), 3, to.b[i]);
      }
    }
  }

  /// With the hoop strain as entry (2, 2).
  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      const ElasticKernel::TakeGradient& take, Index first, Index end) override;

 private:
  struct Face {
    double b[4][3];              // d/dr, d/dz, hoop
    double mu, lambda, shear;    // times the volume
    std::array<Index, 4> place;  // see FaceRows
  };
  void internal_forces() override;

  std::vector<Face> faces_;
};

void AxisymmetricKernel::internal_forces() {
  for (const Face& f : faces_) {
    double radial = 0, axial = 0, hoop = 0, slide = 0;  // strains, the last one an angle
    for (std::size_t i = 0; i < 4; ++i) {
      const double* u = space_.value(f.place[i]);
      radial += f.b[i][0] * u[0];
      axial += f.b[i][1] * u[1];
      hoop += f.b[i][2] * u[0];
      slide += f.b[i][1] * u[0] + f.b[i][0] * u[1];
    }
    const double mean = f.lambda * (radial + axial + hoop);
    const double stress[4] = {mean + 2 * f.mu * radial, mean + 2 * f.mu * axial, mean + 2 * f.mu * hoop,
                              f.shear * slide};
    for (std::size_t i = 0; i < 4; ++i) {
      double* to = space_.force_at(f.place[i]);
      to[0] += stress[0] * f.b[i][0] + stress[3] * f.b[i][1] + stress[2] * f.b[i][2];
      to[1] += stress[1] * f.b[i][1] + stress[3] * f.b[i][0];
    }
  }
}

void AxisymmetricKernel::face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                        const ElasticKernel::TakeGradient& take, Index first, Index end) {
  const mesh::Mesh& mesh = space_.mesh();
  space_.fill(unknowns, known);
  for (Index f = first; f < end; ++f) {
    const FaceRows face = ring_rows(mesh, space_.rows(), f);
    Tensor3 gradient = Tensor3::Zero();
    for (const FaceRows::Row& row : face.all()) {
      const double* u = space_.value(row.place);
      for (Index j = 0; j < 2; ++j)
        for (Index k = 0; k < 2; ++k)
          if (j == k || face.has_shear) gradient(j, k) += row.b[j] * u[k];
      gradient(2, 2) += row.b[2] * u[0];
    }
    // At the surface itself: that of half a cell's middle would be the surface's to first order only.
    if (f >= mesh.n_interior && face.has_shear)
      gradient(2, 2) = space_.value(face.row[1].place)[0] / space_.rows().geometry().face_centre[f][0];
    take(f, gradient);
  }
}

}  // namespace

std::unique_ptr<ElasticKernel::Implementation> make_axisymmetric_kernel(const mesh::Mesh& mesh,
                                                                        const ElasticOperator& rows) {
  return std::make_unique<AxisymmetricKernel>(mesh, rows);
}

}  // namespace couplet::elastic
