// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/state/state_io.hpp"

#include <string>

namespace couplet::fluid {
namespace {

template <int D>
void read_vectors(io::CheckpointReader& file, const std::string& name, Vectors<D>& values, std::size_t n) {
  values.resize(n);
  file.read(name, flat<D>(values));
}

template <int D>
void write_waves(io::CheckpointWriter& file, const State<D>& s, int levels) {
  for (int k = 0; k < levels; ++k) {
    const std::string name = "pressure-" + std::to_string(k);
    file.write_scalar(name + "-upstream", s.pressure[k]->upstream);
    file.write(name + "-end", s.pressure[k]->end);
  }
  file.write("openings", s.openings.now);
  file.write("openings-old", s.openings.old);
  file.write("openings-mean", s.openings.mean);
}

template <int D>
void read_waves(io::CheckpointReader& file, const mesh::Mesh& mesh, State<D>& s, int levels) {
  const std::size_t cells = mesh.cells.n_local(), faces = mesh.boundary.n_owned();
  for (int k = 0; k < levels; ++k) {
    const std::string name = "pressure-" + std::to_string(k);
    auto level = std::make_shared<PressureLevel<D>>(*s.pressure[k]);
    level->upstream = file.read_scalar(name + "-upstream");
    level->end = file.read_or_none(name + "-end", cells + 1);
    s.pressure[k] = level;
  }
  s.openings.now = file.read_or_none("openings", faces);
  s.openings.old = file.read_or_none("openings-old", faces);
  s.openings.mean = file.read("openings-mean");
}

}  // namespace

template <int D>
void write_state(io::CheckpointWriter& file, const State<D>& s, bool compressible) {
  int levels = 0;
  while (levels < 3 && s.pressure[levels]) ++levels;
  file.write_scalar("time", s.time);
  file.write_scalar("dt-old", s.dt_old);
  file.write_scalar("implicit", s.implicit ? 1 : 0);
  file.write_scalar("start", static_cast<int>(s.start));
  file.write_scalar("energy", s.ledger.energy);
  file.write_scalar("energy-largest", s.ledger.largest);
  file.write_scalar("energy-excess", s.ledger.excess);
  file.write_scalar("energy-reference", s.ledger.reference);
  file.write_scalar("energy-level", s.ledger.level);
  file.write_scalar("energy-work", s.ledger.work);
  file.write_scalar("pressure-levels", levels);
  file.write_scalar("has-mesh-flux", s.mesh_flux.empty() ? 0 : 1);
  file.write_scalar("has-flux-memory", s.memory.empty() ? 0 : 1);
  file.write_scalar("has-turn", s.turns ? 1 : 0);
  file.write("velocity", flat<D>(s.u));
  file.write("wall-turn", flat<D>(s.turn));
  file.write("given-velocity", flat<D>(s.w));
  file.write("boundary-velocity", flat<D>(s.u_boundary));
  file.write("flux", s.phi);
  file.write("flux-memory", s.memory);
  for (int k = 0; k < levels; ++k) {
    const std::string name = "pressure-" + std::to_string(k);
    file.write_scalar(name + "-time", s.pressure[k]->time);
    file.write(name, s.pressure[k]->p);
    file.write(name + "-boundary", s.pressure[k]->boundary);
    file.write_scalar(name + "-has-gradient", s.pressure[k]->gradient.empty() ? 0 : 1);
    file.write(name + "-gradient", flat<D>(s.pressure[k]->gradient));
  }
  if (s.dt_old > 0) {
    file.write("old-velocity", flat<D>(s.u_old));
    file.write("old-boundary-velocity", flat<D>(s.u_boundary_old));
    file.write("old-rate", flat<D>(s.rates_old.rate));
    if (s.implicit) file.write("old-viscous-rate", flat<D>(s.rates_old.viscous));
    file.write("old-shear", flat<D>(s.shear_old));
    file.write("old-flux-memory", s.memory_old);
  }
  if (!s.points.empty() || !s.mesh_flux.empty()) {
    file.write("points", {s.points.empty() ? nullptr : s.points.front().data(), 3 * s.points.size()});
    file.write("mesh-flux", s.mesh_flux);
  }
  if (compressible) write_waves(file, s, levels);
}

template <int D>
State<D> read_state(io::CheckpointReader& file, const mesh::Mesh& mesh,
                    std::shared_ptr<const Placement<D>> at_rest, bool compressible) {
  const bool moving = !at_rest;
  State<D> s;
  const std::size_t cells = mesh.cells.n_local(), faces = mesh.boundary.n_owned();
  s.time = file.read_scalar("time");
  s.dt_old = file.read_scalar("dt-old");
  s.implicit = file.read_scalar("implicit") != 0;
  s.start = static_cast<Start>(file.read_count("start", 2));
  s.ledger = {file.read_scalar("energy"),        file.read_scalar("energy-largest"),
              file.read_scalar("energy-excess"), file.read_scalar("energy-reference"),
              file.read_scalar("energy-level"),  file.read_scalar("energy-work")};
  const auto levels = static_cast<int>(file.read_count("pressure-levels", s.pressure.size()));
  const bool has_mesh_flux = file.read_scalar("has-mesh-flux") != 0;
  const bool has_memory = file.read_scalar("has-flux-memory") != 0;
  s.turns = file.read_scalar("has-turn") != 0;
  read_vectors<D>(file, "velocity", s.u, cells);
  read_vectors<D>(file, "wall-turn", s.turn, s.turns ? faces : 0);
  read_vectors<D>(file, "given-velocity", s.w, faces);
  read_vectors<D>(file, "boundary-velocity", s.u_boundary, faces);
  s.phi.resize(mesh.n_flux_faces());
  file.read("flux", s.phi);
  s.memory.resize(has_memory ? mesh.n_interior : 0);
  file.read("flux-memory", s.memory);
  for (int k = 0; k < levels; ++k) {
    const std::string name = "pressure-" + std::to_string(k);
    auto level = std::make_shared<PressureLevel<D>>();
    level->time = file.read_scalar(name + "-time");
    level->p.resize(cells);
    level->boundary.resize(faces);
    file.read(name, level->p);
    file.read(name + "-boundary", level->boundary);
    const bool has_gradient = file.read_scalar(name + "-has-gradient") != 0;
    read_vectors<D>(file, name + "-gradient", level->gradient, has_gradient ? cells : 0);
    s.pressure[k] = level;
  }
  if (s.dt_old > 0) {
    read_vectors<D>(file, "old-velocity", s.u_old, cells);
    read_vectors<D>(file, "old-boundary-velocity", s.u_boundary_old, faces);
    read_vectors<D>(file, "old-rate", s.rates_old.rate, cells);
    if (s.implicit) read_vectors<D>(file, "old-viscous-rate", s.rates_old.viscous, cells);
    read_vectors<D>(file, "old-shear", s.shear_old, faces);
    s.memory_old.resize(has_memory ? mesh.n_interior : 0);
    file.read("old-flux-memory", s.memory_old);
  }
  if (moving) {
    s.points.resize(mesh.points.n_local());
    file.read("points", {s.points.empty() ? nullptr : s.points.front().data(), 3 * s.points.size()});
    s.mesh_flux.resize(has_mesh_flux ? mesh.n_flux_faces() : 0);
    file.read("mesh-flux", s.mesh_flux);
  }
  s.placement = moving ? make_placement<D>(mesh, s.points) : std::move(at_rest);
  if (compressible) read_waves(file, mesh, s, levels);
  return s;
}

template void write_state<2>(io::CheckpointWriter&, const State<2>&, bool);
template void write_state<3>(io::CheckpointWriter&, const State<3>&, bool);
template State<2> read_state<2>(io::CheckpointReader&, const mesh::Mesh&, std::shared_ptr<const Placement<2>>,
                                bool);
template State<3> read_state<3>(io::CheckpointReader&, const mesh::Mesh&, std::shared_ptr<const Placement<3>>,
                                bool);

}  // namespace couplet::fluid
