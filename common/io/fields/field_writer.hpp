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

/// Time series of one participant: <folder>/<name>.h5 with an XDMF index <folder>/<name>.xdmf that Debian's
/// ParaView opens while the run goes on. The HDF5 file is opened, written and closed each time; the index is
/// rewritten atomically. Moving meshes write their points each time; fixed ones once. Collective over
/// mesh.comm.
class FieldWriter {
 public:
  /// restart_time: entries later than this in an existing series are dropped; NaN starts a new series.
  /// `places`: of the local points [m], written once; looked at while the writer is made. Of `choice` box and compression;
  /// where no cell lies in the box there is no file.
  FieldWriter(const mesh::Mesh& mesh, std::span<const Vec3> places, std::filesystem::path folder,
              std::string name, bool moving, double restart_time, const FieldChoice& choice = {});
  /// Of a surface, which `cells` are the faces of.
  FieldWriter(const MeshPart& surface, std::filesystem::path folder, std::string name, bool moving,
              double restart_time);
  ~FieldWriter();
  FieldWriter(const FieldWriter&) = delete;
  /// `points`: per local point; used when moving.
  void write(double time, std::span<const Vec3> points, const std::vector<OutputField>& fields);

 private:
  struct State;
  std::optional<MeshPart> part_;
  std::unique_ptr<State> state_;  // none: nothing lies in the box
};

}  // namespace couplet::io
