// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/state/state_io.hpp"

#include <string>

namespace couplet::fluid {
namespace {

using mesh::Entries;

template <int D>
void read_vectors(io::CheckpointReader& file, Entries entries, const std::string& name, Vectors<D>& values,
                  std::size_t n) {
  values.resize(n);
  file.read(entries, name, flat<D>(values));
}

template <int D>
void write_waves(io::CheckpointWriter& file, const State<D>& s, int levels) {
  for (int k = 0; k < levels; ++k) {
    const std::string name = "pressure-" + std::to_string(k);
    file.write_scalar(name + "-upstream", s.pressure[k]->upstream);
    const std::vector<double>& end = s.pressure[k]->end;  // of the cells, and of the volume upstream
    file.write_scalar(name + "-has-end", end.empty() ? 0 : 1);
    file.write(Entries::cells, name + "-end", std::span(end).first(end.empty() ? 0 : end.size() - 1));
    file.write_scalar(name + "-upstream-end", end.empty() ? 0 : end.back());
  }
  file.write(Entries::owned_boundary, "openings", s.openings.now);
  file.write(Entries::owned_boundary, "openings-old", s.openings.old);
  file.write_common("openings-mean", s.openings.mean);
}

template <int D>
void read_waves(io::CheckpointReader& file, const mesh::Mesh& mesh, State<D>& s, int levels) {
  const std::size_t cells = mesh.cells.n_local();
  for (int k = 0; k < levels; ++k) {
    const std::string name = "pressure-" + std::to_string(k);
    auto level = std::make_shared<PressureLevel<D>>(*s.pressure[k]);
    level->upstream = file.read_scalar(name + "-upstream");
    const bool has_end = file.read_scalar(name + "-has-end") != 0;
    const double upstream_end = file.read_scalar(name + "-upstream-end");
    level->end.resize(has_end ? cells : 0);
    file.read(Entries::cells, name + "-end", level->end);
    if (has_end) level->end.push_back(upstream_end);
    s.pressure[k] = level;
  }
  s.openings.now = file.read_or_none(Entries::owned_boundary, "openings", 1);
  s.openings.old = file.read_or_none(Entries::owned_boundary, "openings-old", 1);
  s.openings.mean = file.read_common("openings-mean");
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
  file.write(Entries::cells, "velocity", flat<D>(s.u));
  file.write(Entries::owned_boundary, "wall-turn", flat<D>(s.turn));
  file.write(Entries::owned_boundary, "given-velocity", flat<D>(s.w));
  file.write(Entries::owned_boundary, "boundary-velocity", flat<D>(s.u_boundary));
  file.write(Entries::flux_faces, "flux", s.phi);
  file.write(Entries::interior_faces, "flux-memory", s.memory);
  for (int k = 0; k < levels; ++k) {
    const std::string name = "pressure-" + std::to_string(k);
    file.write_scalar(name + "-time", s.pressure[k]->time);
    file.write(Entries::cells, name, s.pressure[k]->p);
    file.write(Entries::owned_boundary, name + "-boundary", s.pressure[k]->boundary);
    file.write_scalar(name + "-has-gradient", s.pressure[k]->gradient.empty() ? 0 : 1);
    file.write(Entries::cells, name + "-gradient", flat<D>(s.pressure[k]->gradient));
  }
  if (s.dt_old > 0) {
    file.write(Entries::cells, "old-velocity", flat<D>(s.u_old));
    file.write(Entries::owned_boundary, "old-boundary-velocity", flat<D>(s.u_boundary_old));
    file.write(Entries::cells, "old-rate", flat<D>(s.rates_old.rate));
    if (s.implicit) file.write(Entries::cells, "old-viscous-rate", flat<D>(s.rates_old.viscous));
    file.write(Entries::owned_boundary, "old-shear", flat<D>(s.shear_old));
    file.write(Entries::interior_faces, "old-flux-memory", s.memory_old);
  }
  if (!s.points.empty() || !s.mesh_flux.empty()) {
    file.write(Entries::points, "points",
               {s.points.empty() ? nullptr : s.points.front().data(), 3 * s.points.size()});
    file.write(Entries::flux_faces, "mesh-flux", s.mesh_flux);
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
  read_vectors<D>(file, Entries::cells, "velocity", s.u, cells);
  read_vectors<D>(file, Entries::owned_boundary, "wall-turn", s.turn, s.turns ? faces : 0);
  read_vectors<D>(file, Entries::owned_boundary, "given-velocity", s.w, faces);
  read_vectors<D>(file, Entries::owned_boundary, "boundary-velocity", s.u_boundary, faces);
  s.phi.resize(mesh.n_flux_faces());
  file.read(Entries::flux_faces, "flux", s.phi);
  s.memory.resize(has_memory ? mesh.n_interior : 0);
  file.read(Entries::interior_faces, "flux-memory", s.memory);
  for (int k = 0; k < levels; ++k) {
    const std::string name = "pressure-" + std::to_string(k);
    auto level = std::make_shared<PressureLevel<D>>();
    level->time = file.read_scalar(name + "-time");
    level->p.resize(cells);
    level->boundary.resize(faces);
    file.read(Entries::cells, name, level->p);
    file.read(Entries::owned_boundary, name + "-boundary", level->boundary);
    const bool has_gradient = file.read_scalar(name + "-has-gradient") != 0;
    read_vectors<D>(file, Entries::cells, name + "-gradient", level->gradient, has_gradient ? cells : 0);
    s.pressure[k] = level;
  }
  if (s.dt_old > 0) {
    read_vectors<D>(file, Entries::cells, "old-velocity", s.u_old, cells);
    read_vectors<D>(file, Entries::owned_boundary, "old-boundary-velocity", s.u_boundary_old, faces);
    read_vectors<D>(file, Entries::cells, "old-rate", s.rates_old.rate, cells);
    if (s.implicit) read_vectors<D>(file, Entries::cells, "old-viscous-rate", s.rates_old.viscous, cells);
    read_vectors<D>(file, Entries::owned_boundary, "old-shear", s.shear_old, faces);
    s.memory_old.resize(has_memory ? mesh.n_interior : 0);
    file.read(Entries::interior_faces, "old-flux-memory", s.memory_old);
  }
  if (moving) {
    s.points.resize(mesh.points.n_local());
    file.read(Entries::points, "points",
              {s.points.empty() ? nullptr : s.points.front().data(), 3 * s.points.size()});
    s.mesh_flux.resize(has_mesh_flux ? mesh.n_flux_faces() : 0);
    file.read(Entries::flux_faces, "mesh-flux", s.mesh_flux);
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
