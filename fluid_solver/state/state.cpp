// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

namespace {

using mesh::Entries;

template <class T>
auto doubles_of(T& values) {
  using Value = std::remove_reference_t<decltype(values.front())>;
  using Double = std::conditional_t<std::is_const_v<Value>, const double, double>;
  if constexpr (std::is_same_v<std::remove_const_t<Value>, double>) {
    return std::span<Double>(values);
  } else {
    return std::span<Double>(values.empty() ? nullptr : values.front().data(),
                             values.size() * Value::SizeAtCompileTime);
  }
}

/// Writes what a visit names.
struct Save {
  io::CheckpointWriter& file;
  template <class T>
  void operator()(const std::string& name, const T& value) {
    file.write_scalar(name, static_cast<double>(value));
  }
  template <class T>
  void count(const std::string& name, const T& value, std::size_t) {
    (*this)(name, value);
  }
  template <class T>
  void operator()(Entries entries, const std::string& name, const T& values, bool) {
    file.write(entries, name, doubles_of(values));
  }
  void optional(Entries entries, const std::string& name, const std::vector<double>& values) {
    file.write(entries, name, values);
  }
  void common(const std::string& name, const std::vector<double>& values) { file.write_common(name, values); }
  template <int D>
  const PressureLevel<D>& level(const std::shared_ptr<const PressureLevel<D>>& level) {
    return *level;
  }
};

/// Reads what a visit names. Fields have their full size where they are said to be there, and are empty elsewhere.
struct Load {
  io::CheckpointReader& file;
  const mesh::Mesh& mesh;
  template <class T>
  void operator()(const std::string& name, T& value) {
    if constexpr (std::is_same_v<T, bool>)
      value = file.read_scalar(name) != 0;
    else
      value = file.read_scalar(name);
  }
  template <class T>
  void count(const std::string& name, T& value, std::size_t most) {
    value = static_cast<T>(file.read_count(name, most));
  }
  template <class T>
  void operator()(Entries entries, const std::string& name, T& values, bool is_there) {
    values.resize(is_there ? size_of(entries) : 0);
    file.read(entries, name, doubles_of(values));
  }
  void optional(Entries entries, const std::string& name, std::vector<double>& values) {
    values = file.read_or_none(entries, name, 1);
  }
  void common(const std::string& name, std::vector<double>& values) { values = file.read_common(name); }
  template <int D>
  PressureLevel<D>& level(std::shared_ptr<const PressureLevel<D>>& level) {
    const auto fresh = std::make_shared<PressureLevel<D>>();
    level = fresh;
    return *fresh;
  }
  std::size_t size_of(Entries entries) const {
    switch (entries) {
      case Entries::cells:
        return mesh.cells.n_local();
      case Entries::owned_boundary:
        return mesh.boundary.n_owned();
      case Entries::flux_faces:
        return mesh.n_flux_faces();
      case Entries::interior_faces:
        return mesh.n_interior;
      default:
        return mesh.points.n_local();
    }
  }
};

template <class Level, class F>
void visit_level(Level& level, const std::string& name, bool compressible, F& f) {
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

/// `S`: State, const for Save. The placement follows from the points.
template <class S, class F>
void visit(S& s, bool moving, bool compressible, F f) {
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
  for (std::size_t k = 0; k < levels; ++k)
    visit_level(f.level(s.pressure[k]), "pressure-" + std::to_string(k), compressible, f);
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
  f.optional(Entries::owned_boundary, "openings", s.openings.now);
  f.optional(Entries::owned_boundary, "openings-old", s.openings.old);
  f.common("openings-mean", s.openings.mean);
}

}  // namespace

template <int D>
void write_state(io::CheckpointWriter& file, const State<D>& s, bool compressible) {
  visit(s, !s.points.empty() || !s.mesh_flux.empty(), compressible, Save{file});
}

template <int D>
State<D> read_state(io::CheckpointReader& file, const mesh::Mesh& mesh,
                    std::shared_ptr<const Placement<D>> at_rest, bool compressible) {
  State<D> s;
  visit(s, !at_rest, compressible, Load{file, mesh});
  s.placement = at_rest ? std::move(at_rest) : make_placement<D>(mesh, s.points);
  return s;
}

template void write_state<2>(io::CheckpointWriter&, const State<2>&, bool);
template void write_state<3>(io::CheckpointWriter&, const State<3>&, bool);
template State<2> read_state<2>(io::CheckpointReader&, const mesh::Mesh&, std::shared_ptr<const Placement<2>>,
                                bool);
template State<3> read_state<3>(io::CheckpointReader&, const mesh::Mesh&, std::shared_ptr<const Placement<3>>,
                                bool);

}  // namespace couplet::fluid
