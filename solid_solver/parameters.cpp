// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <algorithm>

#include "common/fv/expression.hpp"
#include "solid_solver/laws/laws.hpp"

namespace couplet {
namespace {

bool takes_temperature(const SolidParameters& p) { return p.interface_data && p.interface_data->temperature; }

void declare_heat(config::Section& s, SolidParameters& p) {
  s.optional_section<HeatParameters>(
      "heat", p.heat, [](config::Section& h, HeatParameters& v) { declare(h, v); },
      "conduction of heat; the temperature of a step is solved for before its displacement");
  s.value("temperature", p.temperature).unit("K").doc("prescribed temperature, of x, y, z, t");
  s.optional_section<ThermalExpansion>(
      "thermal-expansion", p.expansion, [](config::Section& e, ThermalExpansion& v) { declare(e, v); },
      "thermal strain; needs 'heat' or 'temperature', and 'expansion' of the material");
  s.optional_section<InterfaceData>(
      "interface", p.interface_data, [](config::Section& i, InterfaceData& v) { declare(i, v); },
      "what the patches of type 'interface' take from the coupler; absent: forces");
  s.value("stiffness-tolerance", p.stiffness_tolerance)
      .range(0, 0.1)
      .doc(
          "relative change of youngs-modulus-table and poissons-ratio-table at which the matrix is made "
          "anew");
  s.value("thermoelastic-coupling", p.thermoelastic_coupling)
      .doc("a solid that is stretched cools: heat of the strain rate, thesis (2.27), one step late");
  s.check(
      [&] {
        return p.thermoelastic_coupling &&
                       !(p.expansion && p.heat && p.heat->analysis == HeatParameters::Analysis::transient)
                   ? "it needs a transient 'heat' and 'thermal-expansion'"
                   : "";
      },
      "thermoelastic-coupling");
  const auto needs = [&](std::optional<config::ExpressionText> HeatMaterial::*property, bool needed,
                         const char* key, const char* by) {
    s.check(
        [&p, property, needed, key, by]() -> std::string {
          for (const SolidMaterial& m : materials_of(p))
            if (needed && !(m.heat.*property))
              return fmt::format("'{}' of the material is missing; {} needs it", key, by);
          return "";
        },
        p.materials.empty() ? "material" : "materials");
  };
  s.check([&] { return p.temperature ? problem_of(*p.temperature) : ""; }, "temperature");
  s.check(
      [&] {
        return takes_temperature(p) && (p.heat || p.temperature)
                   ? "the temperature is taken at the interface; remove 'heat' or 'temperature'"
                   : "";
      },
      "interface");
  s.check(
      [&] {
        return p.heat && p.temperature ? "'heat' solves for the temperature; remove one of the two" : "";
      },
      "temperature");
  s.check(
      [&] {
        return p.expansion && !p.heat && !p.temperature && !takes_temperature(p)
                   ? "thermal strain needs a temperature; give 'heat' or 'temperature'"
                   : "";
      },
      "thermal-expansion");
  s.check(
      [&] {
        return p.analysis == SolidParameters::Analysis::thermal && !p.heat ? "a thermal analysis needs 'heat'"
                                                                           : "";
      },
      "analysis");
  needs(&HeatMaterial::conductivity, p.heat.has_value(), "conductivity", "'heat'");
  needs(&HeatMaterial::specific_heat, p.heat && p.heat->analysis == HeatParameters::Analysis::transient,
        "specific-heat", "a transient 'heat'");
  needs(&HeatMaterial::expansion, p.expansion.has_value(), "expansion", "'thermal-expansion'");
}

/// Whether a condition of any kind keeps some displacement from being free.
bool is_held(const SolidParameters& p) {
  const auto holds = [](const SolidCondition& c) {
    using Type = SolidCondition::Type;
    return c.type != Type::traction && c.type != Type::pressure && c.type != Type::free &&
           c.type != Type::zero_normal_gradient;
  };
  return std::any_of(p.boundaries.begin(), p.boundaries.end(), [&](const auto& entry) {
    const auto& parts = entry.second.parts;
    return holds(entry.second) || std::any_of(parts.begin(), parts.end(), holds);
  });
}

void check_together(config::Section& s, SolidParameters& p) {
  const auto check_components = [&](const char* key, const std::vector<config::ExpressionText>& texts) {
    s.check([&] { return texts.empty() ? std::string() : problem_of(texts, p.dimension); }, key);
  };
  check_components("body-force", p.body_force);
  check_components("initial-velocity", p.initial_velocity);
  s.check(
      [&] {
        return p.gravity.empty() || std::ssize(p.gravity) == p.dimension
                   ? std::string()
                   : fmt::format("{} components are given where the {}-dimensional scene needs {}",
                                 p.gravity.size(), p.dimension, p.dimension);
      },
      "gravity");
  s.check(
      [&] {
        return p.damping && p.analysis == SolidParameters::Analysis::static_
                   ? "damping has no effect in a static analysis; remove it"
                   : "";
      },
      "damping");
  s.check(
      [&] {
        return p.boundaries.empty() && p.analysis != SolidParameters::Analysis::thermal
                   ? "each patch of the mesh needs an entry"
                   : "";
      },
      "boundaries");
  s.check(
      [&] {
        return p.analysis != SolidParameters::Analysis::static_ || is_held(p)
                   ? ""
                   : "nothing holds the solid of this static analysis: at least one patch must be fixed, supported, "
                     "sprung or on a plane of symmetry";
      },
      "boundaries");
  s.check(
      [&] {
        return p.step_control && p.analysis != SolidParameters::Analysis::dynamic
                   ? "a static analysis has no time error to control; remove it"
                   : "";
      },
      "time-step-control");
}

/// What finite strain cannot have, each with the key to change.
void check_finite_strain(config::Section& s, SolidParameters& p) {
  using Method = MethodParameters;
  const auto refuse = [&](const char* key, bool is_wrong, const char* why) {
    s.check(
        [&p, is_wrong, why] { return has_finite_strain(p) && is_wrong ? std::string(why) : std::string(); },
        key);
  };
  const bool is_dynamic = p.analysis == SolidParameters::Analysis::dynamic;
  refuse("plane", p.dimension == 2 && p.plane == SolidParameters::Plane::stress,
         "finite strain knows plane strain only; model the sheet in 3-D");
  refuse("thermal-expansion", p.expansion.has_value(), "finite strain has no thermal strain");
  refuse("damping", is_dynamic && p.damping && p.damping->stiffness > 0,
         "'stiffness' damps rigid rotations at finite strain; use 'mass', or the losses of 'time-scheme'");
  refuse("interface", p.interface_data && p.interface_data->load == InterfaceData::Load::pressure,
         "finite strain takes forces; 'load: pressure' would not follow the surface");
  s.check(
      [&p]() -> std::string {
        const bool fits = has_finite_strain(p) && p.analysis == SolidParameters::Analysis::dynamic &&
                          p.time_scheme.type == TimeScheme::trapezoidal;
        return p.energy_momentum && !fits
                   ? "it needs 'kinematics: finite-strain', 'analysis: dynamic' and 'time-scheme: {type: trapezoidal}'"
                   : "";
      },
      "energy-momentum");
  refuse("time-step-control", p.step_control.has_value(), "it estimates the error of the linear solid only");
  refuse(
      "solution-method",
      p.method.type == Method::Type::segregated || p.method.type == Method::Type::block_coupled ||
          p.method.face_gradient == Method::FaceGradient::thesis ||
          p.method.face_gradient == Method::FaceGradient::corrected,
      "finite strain is solved by Newton's method on 'face-gradient: symmetric' ('type: newton-krylov' or 'auto')");
  bool has_tables = false;
  for (const SolidMaterial& m : materials_of(p))
    has_tables = has_tables || m.heat.youngs_modulus || m.heat.poissons_ratio;
  s.check(
      [&p]() -> std::string {
        for (const SolidMaterial& m : materials_of(p))
          if (!has_finite_strain(p) && (!m.law.empty() || !m.law_coefficients.empty()))
            return "a law has an effect with 'kinematics: finite-strain' only";
        return "";
      },
      p.materials.empty() ? "material" : "materials");
  refuse("material", has_tables,
         "finite strain takes no tables of the elastic constants over the temperature");
  refuse("output", p.output.spectrum || p.output.modes > 0,
         "'spectrum' and 'modes' are those of the linear solid; use small-strain");
}

}  // namespace

void declare(config::Section& s, SolidParameters& p) {
  using Analysis = SolidParameters::Analysis;
  using Plane = SolidParameters::Plane;
  s.value("mesh", p.mesh).required().doc("mesh file, .msh or .geo, relative to the YAML");
  s.value("mesh-scale", p.mesh_scale)
      .positive()
      .doc(
          "factor of all lengths of the mesh file: 0.001 for a mesh in millimetres; keys that are places stay in metres");
  s.value("mesh-parameters", p.mesh_parameters)
      .doc("numbers for names that the .geo defines by DefineConstant: {n: 8}");
  s.value("dimension", p.dimension).range(2, 3).doc("2: cells in the plane z = 0, unit depth; 3");
  s.choice("plane", p.plane, {{"strain", Plane::strain}, {"stress", Plane::stress}})
      .doc("what a 2-D scene is a cut of");
  s.choice("analysis", p.analysis,
           {{"dynamic", Analysis::dynamic}, {"static", Analysis::static_}, {"thermal", Analysis::thermal}})
      .doc("static leaves out inertia; thermal conducts heat only");
  using Kinematics = SolidParameters::Kinematics;
  s.choice("kinematics", p.kinematics,
           {{"small-strain", Kinematics::small_strain}, {"finite-strain", Kinematics::finite_strain}})
      .doc(
          "finite-strain: large rotations and strains, material.law by an energy, Newton's method on the symmetric "
          "face gradient");
  s.value("energy-momentum", p.energy_momentum)
      .doc(
          "of dynamic finite strain with the trapezoidal rule: the stress of a step does exactly the work that the strain "
          "energy changes by, so that energy and momenta are kept");
  const bool is_elastic = p.analysis != SolidParameters::Analysis::thermal;
  s.optional_section<bool>(
      "material", p.material_given,
      [&p, is_elastic](config::Section& m, bool&) { declare(m, p.material, is_elastic); },
      "linear elastic material of the whole solid");
  s.map<ZoneMaterial>(
      "materials", p.materials,
      [is_elastic](config::Section& m, ZoneMaterial& v) { declare(m, v, is_elastic); }, "material",
      "in place of material: several, each with its zones of the mesh; bonded where they meet");
  s.check(
      [&p] {
        return p.material_given.has_value() == p.materials.empty()
                   ? ""
                   : "give either 'material' (of the whole solid) or 'materials' (by zone of the mesh)";
      },
      "material");
  s.map<SolidBoundary>(
      "boundaries", p.boundaries, [&p](config::Section& b, SolidBoundary& v) { declare(b, v, p.dimension); },
      "patch", "one entry for each patch of the mesh");
  s.value("body-force", p.body_force)
      .unit("N/m^3")
      .doc("force per volume, one expression of x, y, z, t a component");
  s.value("gravity", p.gravity).unit("m/s^2").doc("acceleration of gravity, one number a component");
  s.value("initial-velocity", p.initial_velocity)
      .unit("m/s")
      .doc("velocity at the start, one expression of x, y, z a component");
  s.section(
      "time-scheme", [&](config::Section& t) { declare(t, p.time_scheme); },
      "integration in time of a dynamic analysis");
  s.optional_section<SolidDamping>(
      "damping", p.damping, [](config::Section& d, SolidDamping& v) { declare(d, v); },
      "structural damping; dynamic analysis only");
  declare_heat(s, p);
  s.optional_section<TimeStepControl>(
      "time-step-control", p.step_control, [](config::Section& c, TimeStepControl& v) { declare(c, v); },
      "halves steps ('simulation.time-step' is the longest, 'max-step-halvings' limits) where the estimated "
      "error of "
      "the time scheme asks for it; dynamic analysis only");
  s.section(
      "solution-method", [&](config::Section& m) { declare(m, p.method); },
      "how the equations of a step are solved");
  s.map<SolidProbe>(
      "probes", p.probes, [](config::Section& q, SolidProbe& v) { declare(q, v); }, "probe",
      "places whose displacement is written to probes.csv at each step");
  s.section(
      "output", [&](config::Section& o) { declare(o, p.output); }, "fields written at the output interval");
  check_together(s, p);
  check_finite_strain(s, p);
}

std::vector<SolidMaterial> materials_of(const SolidParameters& p) {
  if (p.materials.empty()) return {p.material};
  std::vector<SolidMaterial> result;
  for (const auto& [name, material] : p.materials) result.push_back(material);
  return result;
}

LameConstants lame_constants(const SolidParameters& p, const SolidMaterial& material) {
  const double e = material.youngs_modulus, nu = material.poissons_ratio;
  LameConstants lame{e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu))};
  // sigma_zz = 0 eliminates the strain across the plane.
  if (p.dimension == 2 && p.plane == SolidParameters::Plane::stress)
    lame.lambda = 2 * lame.lambda * lame.mu / (lame.lambda + 2 * lame.mu);
  return lame;
}

double largest_poissons_ratio(const SolidParameters& p) {
  double largest = -1;
  for (const SolidMaterial& m : materials_of(p)) largest = std::max(largest, m.poissons_ratio);
  return largest;
}

bool symmetric_suits(const SolidParameters& p) {
  using Type = MethodParameters::Type;
  if (p.method.type != Type::automatic && p.method.type != Type::newton_krylov) return false;
  const auto has_no_energy = [](const SolidCondition& c) {
    return c.type == SolidCondition::Type::zero_normal_gradient;
  };
  return std::ranges::none_of(p.boundaries, [&](const auto& entry) {
    return has_no_energy(entry.second) || std::ranges::any_of(entry.second.parts, has_no_energy);
  });
}

bool volume_by_cells(const SolidParameters& p) {
  using VolumeStrain = MethodParameters::VolumeStrain;
  if (p.method.volume_strain != VolumeStrain::automatic) return p.method.volume_strain == VolumeStrain::cells;
  const bool plane_stress = p.dimension == 2 && p.plane == SolidParameters::Plane::stress;
  if (plane_stress || largest_poissons_ratio(p) < nearly_incompressible) return false;
  return !has_finite_strain(p) || std::ranges::all_of(materials_of(p), [](const SolidMaterial& m) {
    return laws::of(m.law)->make({1, 1}, {})->has_bulk();
  });
}

ElasticBody elastic_body(const SolidParameters& p, const Mesh& mesh) {
  std::vector<LameConstants> of_material;
  for (const SolidMaterial& material : materials_of(p)) of_material.push_back(lame_constants(p, material));
  if (mesh.cell_material.empty()) return {{of_material.front()}, {}, volume_by_cells(p)};
  ElasticBody body{{}, mesh.cell_material, volume_by_cells(p)};
  for (const int material : mesh.cell_material) body.lame.push_back(of_material[material]);
  return body;
}

}  // namespace couplet
