// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/io/fields/field_writer.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// Reason why the list `output.surfaces` (patches, or only the word "all") is invalid. Empty if it is valid.
std::string wrong_surfaces(const std::vector<std::string>& names, const std::vector<std::string>& patches);

/// Overload for patches that are the keys of a map.
template <class T>
std::string wrong_surfaces(const std::vector<std::string>& names,
                           const std::map<std::string, T>& of_patches) {
  std::vector<std::string> patches;
  for (const auto& [patch, unused] : of_patches) patches.push_back(patch);
  return wrong_surfaces(names, patches);
}

/// Time series of some patches, written to <folder>/surface-<patch>.h5 and .xdmf as by FieldWriter.
class SurfaceSeries {
 public:
  /// Keeps a reference to `body`. `places` are its local points [m], `names` patches or only the word "all".
  /// Throws Error with `key` if wrong_surfaces() finds a reason. Collective.
  SurfaceSeries(const mesh::Mesh& body, std::span<const Vec3> places, const std::vector<std::string>& names,
                const std::string& key);
  ~SurfaceSeries();
  /// Opens the series in `folder`, see FieldWriter.
  void open(std::filesystem::path folder, bool moving, double restart_time);

  const std::vector<const mesh::Patch*>& patches() const { return patches_; }
  /// Flags the local points of the body on these patches, on all ranks that share them. Collective.
  std::vector<std::uint8_t> points() const;

  /// Writes fields of patches()[i]. `places` are the local points of the body. Fields on "cells" have values
  /// at least at the body's owned boundary faces, others at its points. Collective.
  void write(std::size_t i, double time, std::span<const Vec3> places,
             const std::vector<OutputField>& fields);

 private:
  struct OpenSurface;
  const mesh::Mesh& body_;
  std::vector<const mesh::Patch*> patches_;
  std::vector<std::unique_ptr<OpenSurface>> surfaces_;  // one per patch
};

}  // namespace couplet::io
