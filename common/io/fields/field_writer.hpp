// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/io/fields/mesh_part.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// Time series of one participant: <folder>/<name>.h5 with an XDMF index <folder>/<name>.xdmf that ParaView
/// can open during the run. Each output opens, writes and closes the HDF5 file and replaces the index
/// atomically. Moving meshes write their points at each output, fixed ones once. Collective over mesh.comm.
class FieldWriter {
 public:
  /// Drops entries later than `restart_time` from an existing series; NaN starts a new one. `places` are the
  /// local points [m], read and written here. `choice` sets box and compression. If no cell lies in the box,
  /// no file is written.
  FieldWriter(const mesh::Mesh& mesh, std::span<const Vec3> places, std::filesystem::path folder,
              std::string name, bool moving, double restart_time, const FieldChoice& choice = {});
  /// Writes a surface, whose `cells` are its faces.
  FieldWriter(const MeshPart& surface, std::filesystem::path folder, std::string name, bool moving,
              double restart_time);
  ~FieldWriter();
  FieldWriter(const FieldWriter&) = delete;
  /// Writes an output. `points` per local point are used if the mesh moves.
  void write(double time, std::span<const Vec3> points, const std::vector<OutputField>& fields);

 private:
  struct FieldFiles;
  std::optional<MeshPart> part_;
  std::unique_ptr<FieldFiles> state_;  // nullptr if no cell lies in the box
};

}  // namespace couplet::io
