// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/mesh_block.hpp"

#include "common/base/error.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

using GridPlace = std::array<GlobalIndex, 3>;

/// Numbers on a grid with `n` entries per direction, the first direction fastest.
struct GridNumbers {
  GridPlace n;
  GlobalIndex count() const { return n[0] * n[1] * n[2]; }
  GridPlace place(GlobalIndex number) const {
    return {number % n[0], number / n[0] % n[1], number / n[0] / n[1]};
  }
  GlobalIndex number(const GridPlace& at) const { return at[0] + n[0] * (at[1] + n[1] * at[2]); }
};

class BoxBlock {
 public:
  BoxBlock(const BlockedBox& box, int rank, int ranks)
      : box_(box), points_{{box.n[0] + 1, box.n[1] + 1, box.n[2] + 1}}, grid_{box.n} {
    block_.zones = {"default"};
    block_.patches = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
    block_.point_shares = {points_.count(), ranks};
    block_.cell_shares = {grid_.count() * (box.tetrahedra ? 6 : 1), ranks};
    for (GlobalIndex p = block_.point_shares.first(rank); p < block_.point_shares.first(rank + 1); ++p)
      block_.points.push_back(position(points_.place(p)));
    for (GlobalIndex c = block_.cell_shares.first(rank); c < block_.cell_shares.first(rank + 1); ++c)
      add_cell(c);
  }
  MeshBlock take() { return std::move(block_); }

 private:
  Vec3 position(const GridPlace& at) const {
    const Vec3 s(double(at[0]) / double(box_.n[0]), double(at[1]) / double(box_.n[1]),
                 double(at[2]) / double(box_.n[2]));
    return box_.lower + s.cwiseProduct(box_.upper - box_.lower);
  }

  void add_cell(GlobalIndex cell) {
    const GridPlace at = grid_.place(box_.tetrahedra ? cell / 6 : cell);
    std::array<GlobalIndex, 8> corners{};
    constexpr std::array<std::array<int, 3>, 8> steps{
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
    for (int i = 0; i < 8; ++i)
      corners[i] = points_.number({at[0] + steps[i][0], at[1] + steps[i][1], at[2] + steps[i][2]});
    if (!box_.tetrahedra) return push(CellType::hexahedron, corners);
    // Kuhn's subdivision along the diagonal 0-6, as in make_box().
    constexpr std::array<int, 7> ring{1, 2, 3, 7, 4, 5, 1};
    const auto t = cell % 6;
    push(CellType::tetrahedron, std::array{corners[0], corners[ring[t]], corners[ring[t + 1]], corners[6]});
  }

  void push(CellType type, std::span<const GlobalIndex> points) {
    block_.push_cell(type, 0, points);
    const CellShape& shape = shape_of(type);
    for (int f = 0; f < shape.n_faces; ++f) {
      std::array<GlobalIndex, 4> face{};
      const auto n = std::size_t(shape.face_size(f));
      for (std::size_t i = 0; i < n; ++i) face[i] = points[shape.faces[f][i]];
      const int side = side_of({face.data(), n});
      if (side >= 0) block_.push_element(side, {face.data(), n});
    }
  }

  /// Side of the box that contains these points, or -1.
  int side_of(std::span<const GlobalIndex> face) const {
    for (int axis = 0; axis < 3; ++axis)
      for (const int upper : {0, 1}) {
        bool all = true;
        for (const GlobalIndex p : face)
          all = all && points_.place(p)[axis] == (upper != 0 ? box_.n[axis] : 0);
        if (all) return 2 * axis + upper;
      }
    return -1;
  }

  const BlockedBox& box_;
  GridNumbers points_, grid_;
  MeshBlock block_;
};

}  // namespace

MeshBlock box_block(MPI_Comm comm, const BlockedBox& box) {
  for (int a = 0; a < 3; ++a)
    if (box.n[a] < 1 || box.n[a] > 1000000 || !(box.upper[a] > box.lower[a]))
      throw Error("A box needs 1 to 1000000 cells and a length above zero along each side.");
  return BoxBlock(box, parallel::comm_rank(comm), parallel::comm_size(comm)).take();
}

}  // namespace couplet::mesh
