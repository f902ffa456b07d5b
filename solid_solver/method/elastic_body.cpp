// SPDX-License-Identifier: Apache-2.0
// What the parameters say of the elastic body: constants and matrices of its materials, what suits them.
#include <algorithm>
#include <memory>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/laws/laws.hpp"
#include "solid_solver/method/solution_method.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {
namespace {

/// Elastic matrices of the materials at places.
class Matrices {
 public:
  explicit Matrices(const SolidParameters& p) : parameters_(p) {
    for (const SolidMaterial& m : materials_of(p)) {
      own_.push_back(m.orthotropic
                         ? matrix_of(*m.orthotropic)
                         : elastic::isotropic_matrix(lame_constants(m.youngs_modulus, m.poissons_ratio)));
      axes_.push_back(m.orthotropic ? std::make_unique<MaterialAxes>(*m.orthotropic, p.dimension) : nullptr);
      is_constant_ = is_constant_ && (!axes_.back() || axes_.back()->is_constant());
    }
  }
  std::size_t size() const { return own_.size(); }
  bool is_constant() const { return is_constant_; }
  elastic::ElasticMatrix at(std::size_t material, const Vec3& x) const {
    const Tensor3 axes = axes_[material] ? axes_[material]->at(x) : Tensor3(Tensor3::Identity());
    const elastic::ElasticMatrix matrix = elastic::turned(own_[material], axes);
    const bool plane_stress =
        parameters_.dimension == 2 && parameters_.plane == SolidParameters::Plane::stress;
    return plane_stress ? elastic::in_plane_stress(matrix) : matrix;
  }

 private:
  const SolidParameters& parameters_;
  std::vector<elastic::ElasticMatrix> own_;  // in the axes of the materials
  std::vector<std::unique_ptr<MaterialAxes>> axes_;
  bool is_constant_ = true;
};

/// A matrix a material where its axes are the same everywhere, else one a cell.
void add_matrices(const SolidParameters& p, const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                  elastic::ElasticBody& body) {
  const Matrices matrices(p);
  if (matrices.is_constant()) {
    for (std::size_t m = 0; m < matrices.size(); ++m) body.matrix.push_back(matrices.at(m, Vec3::Zero()));
    if (matrices.size() > 1) body.matrix_of_cell.assign(mesh.cell_material.begin(), mesh.cell_material.end());
    return;
  }
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    body.matrix.push_back(matrices.at(std::size_t(mesh.material_of(c)), geometry.cell_centre[c]));
    body.matrix_of_cell.push_back(c);
  }
}

// Of the norm of a matrix: by so much its mirror image may differ.
constexpr double mirror_tolerance = 1e-6;

}  // namespace

std::vector<SolidMaterial> materials_of(const SolidParameters& p) {
  if (p.materials.empty()) return {p.material};
  std::vector<SolidMaterial> result;
  for (const auto& [name, material] : p.materials) result.push_back(material);
  return result;
}

elastic::LameConstants lame_constants(double e, double nu) {
  return {e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu))};
}

elastic::LameConstants lame_constants(const SolidParameters& p, const SolidMaterial& material) {
  elastic::LameConstants lame = material.orthotropic
                                    ? elastic::isotropic_mean(matrix_of(*material.orthotropic))
                                    : lame_constants(material.youngs_modulus, material.poissons_ratio);
  // sigma_zz = 0 eliminates the strain across the plane.
  if (p.dimension == 2 && p.plane == SolidParameters::Plane::stress)
    lame.lambda = 2 * lame.lambda * lame.mu / (lame.lambda + 2 * lame.mu);
  return lame;
}

double largest_poissons_ratio(const SolidParameters& p) {
  double largest = -1;
  for (const SolidMaterial& m : materials_of(p)) {
    if (m.orthotropic) {
      const elastic::LameConstants lame = elastic::isotropic_mean(matrix_of(*m.orthotropic));
      largest = std::max(largest, lame.lambda / (2 * (lame.lambda + lame.mu)));
    } else {
      largest = std::max(largest, m.poissons_ratio);
    }
  }
  return largest;
}

bool has_orthotropic(const SolidParameters& p) {
  return std::ranges::any_of(materials_of(p),
                             [](const SolidMaterial& m) { return m.orthotropic.has_value(); });
}

bool symmetric_suits(const SolidParameters& p) {
  using Type = MethodParameters::Type;
  if (p.method.type != Type::automatic && p.method.type != Type::newton_krylov) return false;
  return std::ranges::none_of(p.boundaries, [&](const auto& entry) {
    return has_no_energy(entry.second) || std::ranges::any_of(entry.second.parts, has_no_energy);
  });
}

elastic::VolumeStrain volume_strain_of(const SolidParameters& p) {
  using Chosen = MethodParameters::VolumeStrain;
  if (face_gradient_scheme(p) != elastic::FaceGradientScheme::symmetric ||
      p.method.volume_strain == Chosen::faces)
    return elastic::VolumeStrain::faces;
  if (p.method.volume_strain == Chosen::cells) return elastic::VolumeStrain::cells;
  if (p.method.volume_strain == Chosen::shared) return elastic::VolumeStrain::shared;
  const bool plane_stress = p.dimension == 2 && p.plane == SolidParameters::Plane::stress;
  if (plane_stress || is_axisymmetric(p) || has_orthotropic(p) ||
      largest_poissons_ratio(p) < nearly_incompressible)
    return elastic::VolumeStrain::faces;
  const bool has_bulk =
      !has_finite_strain(p) || std::ranges::all_of(materials_of(p), [](const SolidMaterial& m) {
        return laws::of(m.law)->make({1, 1}, {})->has_bulk();
      });
  return has_bulk ? elastic::VolumeStrain::cells : elastic::VolumeStrain::faces;
}

elastic::ElasticBody elastic_body(const SolidParameters& p, const mesh::Mesh& mesh,
                                  const mesh::Geometry& geometry) {
  std::vector<elastic::LameConstants> of_material;
  for (const SolidMaterial& material : materials_of(p)) of_material.push_back(lame_constants(p, material));
  elastic::ElasticBody body{{}, mesh.cell_material, volume_strain_of(p)};
  if (mesh.cell_material.empty()) body.lame = {of_material.front()};
  for (const int material : mesh.cell_material) body.lame.push_back(of_material[material]);
  body.axisymmetric = is_axisymmetric(p);
  if (has_orthotropic(p)) add_matrices(p, mesh, geometry, body);
  return body;
}

void check_symmetry(const SolidParameters& p, const mesh::Mesh& mesh, const elastic::ElasticOperator& rows) {
  const mesh::Geometry& geometry = rows.geometry();
  if (!rows.is_anisotropic()) return;
  const Matrices matrices(p);
  double worst = 0;
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
    if (!rows.mirrored(f)) continue;
    const Vec3 n = geometry.face_area[f].normalized();
    const elastic::ElasticMatrix here =
        matrices.at(std::size_t(mesh.material_of(mesh.owner[f])), geometry.face_centre[f]);
    const elastic::ElasticMatrix mirrored =
        elastic::turned(here, Tensor3::Identity() - 2 * n * n.transpose());
    worst = std::max(worst, (mirrored - here).norm() / here.norm());
  }
  if (parallel::max(mesh.comm, worst) > mirror_tolerance)
    throw Error(
        "boundaries: a 'symmetry' plane is oblique to the axes of an orthotropic material, so one half is "
        "not the mirror image of the other; use 'frictionless', or align 'material.orthotropic.first-axis'.");
}

}  // namespace couplet::solid
