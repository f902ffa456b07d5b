// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/surface_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/io/fields/mesh_part.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {
namespace {

/// Boundary patches with faces, in the order of the mesh. Collective.
std::vector<const mesh::Patch*> patches_with_faces(const mesh::Mesh& body) {
  std::vector<const mesh::Patch*> found;
  for (const mesh::Patch& patch : body.patches)
    if (!patch.bonded && parallel::sum(body.comm, GlobalIndex(patch.count)) > 0) found.push_back(&patch);
  return found;
}

std::string file_name(std::string patch) {
  std::ranges::replace(patch, '/', '_');
  return "surface-" + patch;
}

bool is_all(const std::vector<std::string>& names) { return names.size() == 1 && names.front() == "all"; }

}  // namespace

std::string wrong_surfaces(const std::vector<std::string>& names, const std::vector<std::string>& patches) {
  if (is_all(names)) return "";
  for (const std::string& name : names)
    if (std::ranges::find(patches, name) == patches.end())
      return fmt::format("'{}' is not a patch of the boundary. {} The single word 'all' selects all of them",
                         name, base::did_you_mean(name, patches, "patches"));
  return "";
}

struct SurfaceSeries::OpenSurface {
  MeshPart surface;
  std::optional<FieldWriter> writer{};
};

SurfaceSeries::SurfaceSeries(const mesh::Mesh& body, std::span<const Vec3> places,
                             const std::vector<std::string>& names, const std::string& key)
    : body_(body) {
  std::vector<std::string> known;
  const std::vector<const mesh::Patch*> there = patches_with_faces(body);
  for (const mesh::Patch* patch : there) known.push_back(patch->name);
  if (const std::string trouble = wrong_surfaces(names, known); !trouble.empty())
    throw Error("{}: {}.", key, trouble);
  if (is_all(names))
    patches_ = there;
  else
    for (const std::string& name : names)
      patches_.push_back(there[std::size_t(std::ranges::find(known, name) - known.begin())]);
  for (const mesh::Patch* patch : patches_)
    surfaces_.push_back(std::make_unique<OpenSurface>(make_surface(body, places, *patch)));
}

SurfaceSeries::~SurfaceSeries() = default;

void SurfaceSeries::open(std::filesystem::path folder, bool moving, double restart_time) {
  for (std::size_t i = 0; i < patches_.size(); ++i)
    surfaces_[i]->writer.emplace(surfaces_[i]->surface, folder, file_name(patches_[i]->name), moving,
                                 restart_time);
}

std::vector<std::uint8_t> SurfaceSeries::points() const {
  std::vector<double> flags(body_.points.n_local(), 0);
  for (const auto& one : surfaces_)
    for (const Index v : one->surface.points) flags[v] = 1;
  body_.points.update_ghosts(flags);
  return {flags.begin(), flags.end()};
}

void SurfaceSeries::write(std::size_t i, double time, std::span<const Vec3> places,
                          const std::vector<OutputField>& fields) {
  const mesh::Patch& patch = *patches_[i];
  OpenSurface& one = *surfaces_[i];
  std::vector<Vec3> points;
  for (const Index v : one.surface.points) points.push_back(places[v]);
  std::deque<std::vector<double>> values;
  std::vector<OutputField> here = fields;
  for (OutputField& field : here) {
    const std::size_t n = field.components;
    if (field.place == OutputField::Place::cells)
      field.values = field.values.subspan(std::size_t(patch.first - body_.n_interior) * n, patch.count * n);
    else
      field = picked(field, one.surface.points, values.emplace_back());
  }
  one.writer->write(time, points, here);
}

}  // namespace couplet::io
