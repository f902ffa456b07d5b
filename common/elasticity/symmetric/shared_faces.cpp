// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/shared_faces.hpp"

#include "common/elasticity/symmetric/symmetric_faces.hpp"

namespace couplet::elastic {

SharedFaces shared_faces(const mesh::Mesh& mesh, const ElasticOperator& rows) {
  SharedFaces result;
  if (mesh.dim == 2) return result;
  std::vector<Index> elsewhere;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.face_points[f].size() != 3) continue;
    if (mesh.owner[f] >= mesh.cells.n_owned()) {
      elsewhere.push_back(f);
      continue;
    }
    result.faces.push_back(f);
    result.volume.push_back(symmetric_face<3>(mesh, rows, f).volume);
  }
  result.n_mine = result.faces.size();
  result.faces.insert(result.faces.end(), elsewhere.begin(), elsewhere.end());
  result.volume.resize(result.faces.size(), 0);
  return result;
}

void find_edge_stresses(const SharedFaces& shared, std::span<const Tensor3> stress, SharedEdges& edges) {
  edges.clear();
  for (std::size_t i = 0; i < shared.n_mine; ++i) {
    const Tensor3& s = stress[std::size_t(shared.faces[i])];
    const double part = SharedEdges::share * shared.volume[i] / 3;
    const double entries[6] = {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)};
    for (const Index e : edges.edges_of(i))
      for (int k = 0; k < 6; ++k) edges.at(e)[k] += part * entries[k];
  }
  edges.finish_means();
}

Tensor3 edge_tensor(SharedEdges& edges, Index e) {
  const double* v = edges.at(e);
  Tensor3 s;
  s << v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2];
  return s;
}

}  // namespace couplet::elastic
