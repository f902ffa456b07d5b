// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

namespace {

using mesh::Entries;

template <class T>
std::span<double> doubles_of(std::vector<T>& values) {
  if constexpr (std::is_same_v<T, double>)
    return values;
  else
    return {values.empty() ? nullptr : values.front().data(), values.size() * T::SizeAtCompileTime};
}

/// Saves or loads the visited data. Fields have full size if they exist, else they are empty.
struct StateFile {
  io::CheckpointWriter* out;
  io::CheckpointReader* in;
  const mesh::Mesh* mesh;  ///< with `in`

  template <class T>
  void operator()(const std::string& name, T& value) {
    if (out)
      out->write_scalar(name, static_cast<double>(value));
    else
      value = static_cast<T>(in->read_scalar(name));
  }
  template <class T>
  void count(const std::string& name, T& value, std::size_t most) {
    if (out)
      out->write_scalar(name, static_cast<double>(value));
    else
      value = static_cast<T>(in->read_count(name, most));
  }
  template <class T>
  void operator()(Entries entries, const std::string& name, T& values, bool is_there) {
    if (out) return out->write(entries, name, doubles_of(values));
    values.resize(is_there ? size_of(entries) : 0);
    in->read(entries, name, doubles_of(values));
  }
  std::size_t size_of(Entries entries) const {
    switch (entries) {
      case Entries::cells:
        return mesh->cells.n_local();
      case Entries::owned_boundary:
        return mesh->boundary.n_owned();
      case Entries::flux_faces:
        return mesh->n_flux_faces();
      case Entries::interior_faces:
        return mesh->n_interior;
      default:
        return mesh->points.n_local();
    }
  }
};

template <int D>
void visit_level(PressureLevel<D>& level, const std::string& name, bool compressible, StateFile& f) {
  f(name + "-time", level.time);
  f(Entries::cells, name, level.p, true);
  f(Entries::owned_boundary, name + "-boundary", level.boundary, true);
  bool has_gradient = !level.gradient.empty(), has_end = !level.end.empty();
  f(name + "-has-gradient", has_gradient);
  f(Entries::cells, name + "-gradient", level.gradient, has_gradient);
  if (!compressible) return;
  f(name + "-upstream", level.upstream);
  f(name + "-has-end", has_end);
  f(Entries::cells, name + "-end", level.end, has_end);
  f(name + "-upstream-end", level.upstream_end);
}

/// The placement follows from the points.
template <int D>
void visit(State<D>& s, bool moving, bool compressible, StateFile f) {
  std::size_t levels = 0;
  while (levels < s.pressure.size() && s.pressure[levels]) ++levels;
  bool has_mesh_flux = !s.mesh_flux.empty(), has_memory = !s.memory.empty();
  f("time", s.time);
  f("dt-old", s.dt_old);
  f("implicit", s.implicit);
  f.count("start", s.start, 2);
  f("energy", s.ledger.energy);
  f("energy-largest", s.ledger.largest);
  f("energy-excess", s.ledger.excess);
  f("energy-reference", s.ledger.reference);
  f("energy-level", s.ledger.level);
  f("energy-work", s.ledger.work);
  f.count("pressure-levels", levels, s.pressure.size());
  f("has-mesh-flux", has_mesh_flux);
  f("has-flux-memory", has_memory);
  f("has-turn", s.turns);
  f(Entries::cells, "velocity", s.u, true);
  f(Entries::owned_boundary, "wall-turn", s.turn, s.turns);
  f(Entries::owned_boundary, "given-velocity", s.w, true);
  f(Entries::owned_boundary, "boundary-velocity", s.u_boundary, true);
  f(Entries::flux_faces, "flux", s.phi, true);
  f(Entries::interior_faces, "flux-memory", s.memory, has_memory);
  for (std::size_t k = 0; k < levels; ++k) {
    const auto level = f.out ? std::const_pointer_cast<PressureLevel<D>>(s.pressure[k])
                             : std::make_shared<PressureLevel<D>>();
    visit_level(*level, "pressure-" + std::to_string(k), compressible, f);
    s.pressure[k] = level;
  }
  if (s.dt_old > 0) {
    f(Entries::cells, "old-velocity", s.u_old, true);
    f(Entries::owned_boundary, "old-boundary-velocity", s.u_boundary_old, true);
    f(Entries::cells, "old-rate", s.rates_old.rate, true);
    if (s.implicit) f(Entries::cells, "old-viscous-rate", s.rates_old.viscous, true);
    f(Entries::owned_boundary, "old-shear", s.shear_old, true);
    f(Entries::interior_faces, "old-flux-memory", s.memory_old, has_memory);
  }
  if (moving) {
    f(Entries::points, "points", s.points, true);
    f(Entries::flux_faces, "mesh-flux", s.mesh_flux, has_mesh_flux);
  }
  if (!compressible) return;
  if (f.out) {
    f.out->write(Entries::owned_boundary, "openings", s.openings.now);
    f.out->write(Entries::owned_boundary, "openings-old", s.openings.old);
    f.out->write_common("openings-mean", s.openings.mean);
  } else {
    s.openings.now = f.in->read_or_none(Entries::owned_boundary, "openings", 1);
    s.openings.old = f.in->read_or_none(Entries::owned_boundary, "openings-old", 1);
    s.openings.mean = f.in->read_common("openings-mean");
  }
}

}  // namespace

template <int D>
void write_state(io::CheckpointWriter& file, const State<D>& s, bool compressible) {
  // Writing does not change the state.
  visit(const_cast<State<D>&>(s), !s.points.empty() || !s.mesh_flux.empty(), compressible,
        {&file, nullptr, nullptr});
}

template <int D>
State<D> read_state(io::CheckpointReader& file, const mesh::Mesh& mesh,
                    std::shared_ptr<const Placement<D>> at_rest, bool compressible) {
  State<D> s;
  visit(s, !at_rest, compressible, {nullptr, &file, &mesh});
  s.placement = at_rest ? std::move(at_rest) : make_placement<D>(mesh, s.points);
  return s;
}

template void write_state<2>(io::CheckpointWriter&, const State<2>&, bool);
template void write_state<3>(io::CheckpointWriter&, const State<3>&, bool);
template decltype(read_state<2>) read_state<2>;
template decltype(read_state<3>) read_state<3>;

}  // namespace couplet::fluid
