// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/material_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/config/values.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/laws/laws.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

namespace {

std::string problem_of_numbers(const std::vector<double>& values, bool positive, const char* what) {
  if (values.size() != 3) return fmt::format("{} numbers are given, but {} are needed", values.size(), what);
  if (positive && !std::ranges::all_of(values, [](double v) { return v > 0; }))
    return "all three must be positive";
  return "";
}

std::string problem_of_constants(const Orthotropic& m) {
  if (!problem_of_numbers(m.youngs_moduli, true, "").empty() || m.poissons_ratios.size() != 3 ||
      !problem_of_numbers(m.shear_moduli, true, "").empty())
    return "";  // said already
  return elastic::is_positive(matrix_of(m))
             ? ""
             : "these moduli violate positive strain energy: |nu_ij| must be below sqrt(E_i / E_j), and 1 - "
               "nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13 positive (nu_ji = nu_ij E_j / E_i)";
}

}  // namespace

void declare(config::Section& s, Orthotropic& m) {
  s.value("youngs-moduli", m.youngs_moduli).unit("Pa", 100, 2e12).required().doc("E1, E2, E3");
  s.check([&m] { return problem_of_numbers(m.youngs_moduli, true, "three (E1, E2, E3)"); }, "youngs-moduli");
  s.value("poissons-ratios", m.poissons_ratios)
      .required()
      .doc("nu12, nu23, nu13; nu12: contraction along 2 under tension along 1, nu21 = nu12 E2 / E1");
  s.check([&m] { return problem_of_numbers(m.poissons_ratios, false, "three (nu12, nu23, nu13)"); },
          "poissons-ratios");
  s.value("shear-moduli", m.shear_moduli).unit("Pa", 100, 2e12).required().doc("G12, G23, G13");
  s.check([&m] { return problem_of_numbers(m.shear_moduli, true, "three (G12, G23, G13)"); }, "shear-moduli");
  s.check([&m] { return problem_of_constants(m); }, "poissons-ratios");
  s.value("first-axis", m.first_axis)
      .doc("direction of axis 1, one expression of x, y, z per component, any length; default: x");
  s.value("second-axis", m.second_axis)
      .doc(
          "axis 2, of which only the part normal to axis 1 counts; default: y; in two dimensions it follows "
          "from axis 1");
}

elastic::ElasticMatrix matrix_of(const Orthotropic& m) {
  elastic::OrthotropicConstants c;
  std::copy_n(m.youngs_moduli.begin(), 3, c.youngs_modulus.begin());
  std::copy_n(m.poissons_ratios.begin(), 3, c.poissons_ratio.begin());
  std::copy_n(m.shear_moduli.begin(), 3, c.shear_modulus.begin());
  return elastic::orthotropic_matrix(c);
}

MaterialAxes::MaterialAxes(const Orthotropic& m, int dimension) : dimension_(dimension) {
  if (!m.first_axis.empty())
    first_ = fv::make_expressions(m.first_axis, dimension, "material.orthotropic.first-axis");
  if (!m.second_axis.empty() && dimension == 2)
    throw Error(
        "material.orthotropic.second-axis: in two dimensions the second axis follows from the first "
        "(rotated by 90 degrees); remove it.");
  if (!m.second_axis.empty())
    second_ = fv::make_expressions(m.second_axis, dimension, "material.orthotropic.second-axis");
  for (const auto* axis : {&first_, &second_})
    for (const fv::Expression& e : *axis) is_constant_ = is_constant_ && !e.uses_space();
}

Tensor3 MaterialAxes::at(const Vec3& place) const {
  const auto value = [&](const std::vector<fv::Expression>& axis, Vec3 absent) {
    for (std::size_t a = 0; a < axis.size(); ++a) absent[Index(a)] = axis[a](place, 0);
    return absent;
  };
  const Vec3 first = value(first_, Vec3::UnitX());
  Vec3 second = dimension_ == 2 ? Vec3(-first[1], first[0], 0) : value(second_, Vec3::UnitY());
  const double length = first.norm(), size = second.norm();
  if (length > 0) second -= first * (first.dot(second) / (length * length));
  if (!(length > 0) || !(second.norm() > 1e-6 * size))
    throw Error(
        "material.orthotropic: at ({:.4g}, {:.4g}, {:.4g}) m 'first-axis' and 'second-axis' are zero or "
        "parallel; they must span a plane.",
        place[0], place[1], place[2]);
  Tensor3 axes;
  axes.col(0) = first / length;
  axes.col(1) = second.normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

namespace {

void declare_law(config::Section& s, SolidMaterial& m) {
  std::string doc =
      "material law at finite strain, with Young's modulus and Poisson's ratio as its "
      "small-strain values: " +
      base::join(laws::names());
  s.value("law", m.law).doc(doc);
  s.check(
      [&m]() -> std::string {
        if (m.law.empty() || laws::find(m.law)) return "";
        return fmt::format("unknown law '{}'. {} The laws are {}", m.law,
                           base::did_you_mean(m.law, laws::names(), "laws"), base::join(laws::names()));
      },
      "law");
  std::string wanted;
  for (const laws::Entry& e : laws::all())
    if (e.n_coefficients > 0)
      wanted += fmt::format("{}{}: {}", wanted.empty() ? "" : "; ", e.name, e.coefficients);
  s.value("law-coefficients", m.law_coefficients).doc("additional parameters of the law; " + wanted);
  s.check(
      [&m]() -> std::string {
        const laws::Entry* law = laws::of(m.law);
        if (!law || m.law_coefficients.size() <= law->n_coefficients) return "";
        return law->n_coefficients == 0
                   ? fmt::format("the law '{}' has no parameters", law->name)
                   : fmt::format("{} numbers are given, but the law '{}' takes at most {}: {}",
                                 m.law_coefficients.size(), law->name, law->n_coefficients,
                                 law->coefficients);
      },
      "law-coefficients");
}

}  // namespace

void declare(config::Section& s, SolidMaterial& m, bool is_elastic) {
  s.value("density", m.density).unit("kg/m^3", 1, 25000).positive().required().doc("density");
  if (is_elastic)
    s.optional_section<Orthotropic>(
        "orthotropic", m.orthotropic, [](config::Section& o, Orthotropic& v) { declare(o, v); },
        "elastic constants of a material with three planes of symmetry (wood, plies), instead of "
        "youngs-modulus and poissons-ratio");
  const auto needed = [&](config::Key& key) -> config::Key& {
    return is_elastic && !m.orthotropic ? key.required() : key;
  };
  needed(s.value("youngs-modulus", m.youngs_modulus)
             .unit("Pa", 1, 2e12)
             .positive()
             .doc("Young's modulus; needed without 'orthotropic'"));
  needed(
      s.value("poissons-ratio", m.poissons_ratio)
          .range(-0.99, 0.49999)
          .doc("Poisson's ratio, needed without 'orthotropic'; from 0.4 the symmetric face gradient is the "
               "default"));
  s.check(
      [&m] {
        return m.orthotropic && (m.youngs_modulus != 0 || m.poissons_ratio != 0)
                   ? "give either 'orthotropic' or 'youngs-modulus' and 'poissons-ratio'"
                   : "";
      },
      "orthotropic");
  s.doubt([&m] { return config::check_wave_speed(m.youngs_modulus, m.density); }, "density");
  s.value("yield-strength", m.yield_strength)
      .unit("Pa", 1000, 1e11)
      .positive()
      .doc("the run reports where the equivalent stress reaches this value; the key has no other effect");
  if (is_elastic) declare_law(s, m);
  declare(s, m.heat);
}

void declare(config::Section& s, ZoneMaterial& m, bool is_elastic) {
  s.value("zones", m.zones)
      .doc(
          "physical volumes (2-D: surfaces) of the mesh made of this material; default: the one with this "
          "name");
  declare(s, static_cast<SolidMaterial&>(m), is_elastic);
}

std::vector<std::vector<std::string>> zones_of(const ZoneMaterials& materials) {
  std::vector<std::vector<std::string>> zones;
  for (const auto& [name, material] : materials)
    zones.push_back(material.zones.empty() ? std::vector<std::string>{name} : material.zones);
  return zones;
}

// The elastic body from the parameters: constants and matrices of its materials, and applicable methods.

namespace {

/// Elastic matrices of the materials as a function of position.
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
    return is_plane_stress(parameters_) ? elastic::in_plane_stress(matrix) : matrix;
  }

 private:
  const SolidParameters& parameters_;
  std::vector<elastic::ElasticMatrix> own_;  // in the axes of the materials
  std::vector<std::unique_ptr<MaterialAxes>> axes_;
  bool is_constant_ = true;
};

/// Adds one matrix per material if its axes are uniform, else one per cell.
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

// Tolerance of the mirror image relative to the norm of a matrix.
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
  // sigma_zz = 0 eliminates the out-of-plane strain.
  if (is_plane_stress(p)) lame.lambda = 2 * lame.lambda * lame.mu / (lame.lambda + 2 * lame.mu);
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
  return !any_condition(p, has_no_energy);
}

elastic::FaceGradientScheme face_gradient_scheme(const SolidParameters& p) {
  using FaceGradient = MethodParameters::FaceGradient;
  using Scheme = elastic::FaceGradientScheme;
  if (is_updated_lagrangian(p)) return Scheme::thesis;
  if (has_finite_strain(p) || has_orthotropic(p) || p.method.face_gradient == FaceGradient::symmetric)
    return Scheme::symmetric;
  if (p.method.face_gradient == FaceGradient::thesis) return Scheme::thesis;
  return symmetric_suits(p) ? Scheme::symmetric : Scheme::thesis;
}

elastic::VolumeStrain volume_strain_of(const SolidParameters& p) {
  using Chosen = MethodParameters::VolumeStrain;
  if (face_gradient_scheme(p) != elastic::FaceGradientScheme::symmetric ||
      p.method.volume_strain == Chosen::faces)
    return elastic::VolumeStrain::faces;
  if (p.method.volume_strain == Chosen::cells) return elastic::VolumeStrain::cells;
  if (p.method.volume_strain == Chosen::shared) return elastic::VolumeStrain::shared;
  if (is_plane_stress(p) || is_axisymmetric(p) || has_orthotropic(p) ||
      largest_poissons_ratio(p) < nearly_incompressible)
    return elastic::VolumeStrain::faces;
  const bool has_bulk =
      !has_finite_strain(p) || std::ranges::all_of(materials_of(p), [](const SolidMaterial& m) {
        return laws::of(m.law)->make({1, 1}, {}).has_bulk;
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
