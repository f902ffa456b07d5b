// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/load.hpp"
#include "tests/support/test.hpp"

namespace couplet {

/// A little program's parameters with every kind of key.
struct Boundary {
  enum class Type { wall, inlet, outlet } type = Type::wall;
  Vec3 velocity = Vec3::Zero();
  double pressure = 0;
};
struct Probe {
  std::string name;
  Vec3 at = Vec3::Zero();
};
struct Damping {
  double mass = 0;
};
struct Parameters {
  enum class Analysis { steady, dynamic } analysis = Analysis::dynamic;
  std::string mesh;
  double youngs_modulus = 0, poisson_ratio = 0.3, interval = 0, temperature = 293.15, relaxation = 0.5;
  int iterations = 20;
  bool large = false;
  config::ExpressionText load;
  Vec3 gravity = Vec3::Zero();
  std::vector<double> times;
  std::vector<std::string> patches;
  std::map<std::string, double> divisions;
  std::optional<double> limit;
  std::optional<Damping> damping;
  std::map<std::string, Boundary> boundaries;
  std::vector<Probe> probes;
};

inline void declare(config::Section& s, Boundary& b) {
  s.variant(
      "type", b.type,
      {{"wall", Boundary::Type::wall, [](config::Section&) {}},
       {"inlet", Boundary::Type::inlet,
        [&b](config::Section& i) {
          i.value("velocity", b.velocity).unit("m/s").required().doc("velocity of what flows in");
        }},
       {"outlet", Boundary::Type::outlet,
        [&b](config::Section& o) { o.value("pressure", b.pressure).unit("Pa").doc("pressure outside"); }}},
      "what the patch is", true);
}

inline void declare(config::Section& s, Parameters& p) {
  s.value("mesh", p.mesh).required().doc("mesh file");
  s.choice("analysis", p.analysis,
           {{"static", Parameters::Analysis::steady}, {"dynamic", Parameters::Analysis::dynamic}})
      .doc("with or without inertia");
  s.section(
      "material",
      [&](config::Section& m) {
        m.value("youngs-modulus", p.youngs_modulus).unit("Pa").positive().required().doc("Young's modulus");
        m.value("poisson-ratio", p.poisson_ratio).range(-1, 0.5).doc("Poisson's ratio");
        m.check([&p] { return p.poisson_ratio == 0.5 ? "0.5 needs a mixed formulation." : ""; },
                "poisson-ratio");
      },
      "linear elastic material");
  s.value("interval", p.interval).unit("s").not_negative().doc("time between outputs");
  s.value("temperature", p.temperature).unit("K").positive();
  s.value("relaxation", p.relaxation).range(0, 1);
  s.value("iterations", p.iterations).range(1, 1000);
  s.value("large", p.large);
  s.value("load", p.load).unit("Pa");
  s.value("gravity", p.gravity).unit("m/s^2");
  s.value("times", p.times).unit("s").not_negative();
  s.value("patches", p.patches);
  s.value("divisions", p.divisions);
  s.value("limit", p.limit).unit("m").positive();
  s.optional_section<Damping>(
      "damping", p.damping,
      [](config::Section& d, Damping& v) { d.value("mass", v.mass).unit("1/s").required(); },
      "proportional damping");
  s.map<Boundary>(
      "boundaries", p.boundaries, [](config::Section& b, Boundary& v) { declare(b, v); }, "patch",
      "one entry for each patch of the mesh");
  s.list<Probe>(
      "probes", p.probes,
      [](config::Section& b, Probe& v) {
        b.value("name", v.name).required();
        b.value("at", v.at).unit("m");
      },
      "points that are written each step");
}

inline config::Section::Declare declaration(Parameters& p) {
  return [&p](config::Section& s) { declare(s, p); };
}

/// The least that is valid.
inline const std::string good = "mesh: a.msh\nmaterial: {youngs-modulus: 5.6 MPa}\n";

inline std::vector<std::string> errors_of(const std::string& text) {
  Parameters p;
  return config::load(config::Document::parse(text, "case.yaml"), "", declaration(p));
}

inline Parameters read(const std::string& text) {
  Parameters p;
  config::load_or_throw(config::Document::parse(text, "case.yaml"), "", declaration(p));
  return p;
}

}  // namespace couplet
