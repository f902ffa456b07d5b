// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/mesh/distributed/mesh_block.hpp"
#include "common/mesh/mesh.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {

/// Type of elements. Those of higher order have nodes beside their corners.
struct MshType {
  int gmsh, n_nodes;
  int dim = 0;
  CellType cell = CellType::triangle;  ///< for types that may be cells
  /// Number of its corners, the first of its nodes.
  int corners() const { return dim < 2 ? dim + 1 : shape_of(cell).n_points; }
};

/// Memory-mapped .msh file that is read from front to back. Pages are released after reading, so that a rank
/// never holds a large file.
class MshCursor {
 public:
  /// Maps the file. Throws Error if it cannot be opened.
  explicit MshCursor(std::filesystem::path file);
  ~MshCursor();
  MshCursor(const MshCursor&) = delete;

  bool binary = false;

  /// Throws Error "file:line: ..." (for binary files "file, byte n, in $Section: ...").
  [[noreturn]] void fail(const std::string& what) const;
  /// Type of this number. Throws Error, see fail(), if it is not supported.
  const MshType& type_or_fail(int gmsh) const;
  const std::filesystem::path& file() const { return file_; }

  std::size_t place() const { return at_; }
  /// Moves to a position in a section.
  void go_to(std::size_t place, const std::string& section);
  bool at_end() const { return at_ >= text_.size(); }
  /// Returns the rest of the current line, trimmed, and moves to the next line.
  std::string line();
  /// Finds the next line that starts a section: "Nodes" for "$Nodes", "" at the end of the file.
  std::string next_section();
  /// Moves behind "$End<section>".
  void skip_section();
  void end_section();

  /// Reads a number as text or bytes, depending on the file.
  int integer() { return binary ? raw<int>() : static_cast<int>(text_integer()); }
  std::size_t size() { return binary ? raw<std::size_t>() : static_cast<std::size_t>(text_integer()); }
  double real() {
    const double value = binary ? raw<double>() : text_real();
    if (!std::isfinite(value)) fail(fmt::format("Expected a finite number, found '{}'.", value));
    return value;
  }
  /// Reads a number that is text in binary files, too.
  long text_integer() { return text_number<long>(); }
  double text_real() { return text_number<double>(); }
  template <class T>
  T raw() {
    if (text_.size() - at_ < sizeof(T)) fail(incomplete);
    T value;
    std::memcpy(&value, text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  /// Skips numbers of `bytes` bytes each, or as many words of text.
  void skip(std::size_t numbers, std::size_t bytes = 8);
  /// Reads a count of items of at least one byte each. Throws Error if the file is too short for them.
  std::size_t count() { return checked(size()); }
  std::size_t text_count() { return checked(static_cast<std::size_t>(text_integer())); }
  std::string quoted();

 private:
  static constexpr const char* incomplete = "The file ends here in the middle of its data. It is incomplete.";
  std::string_view word();
  template <class T>
  T text_number();
  std::size_t checked(std::size_t n) const;
  void give_back_pages();

  std::filesystem::path file_;
  std::string_view text_;  // mapped file
  std::size_t at_ = 0, given_back_ = 0;
  std::string section_;
};

/// Block of this rank for the mesh in a .msh, which the first `holders` ranks read. The order is that of
/// read_msh(). Throws Error with file and line. Collective.
MeshBlock read_msh_block(MPI_Comm comm, const std::filesystem::path& file, int holders);

/// Returns true if the .msh has a version that gmsh must convert. Throws Error if it cannot be opened.
bool is_converted(const std::filesystem::path& file);

/// Returns true if the file is a .msh with elements of this dimension.
bool has_cells(const std::filesystem::path& file, int dim);

/// Elementary entity (gmsh's tag of a curve or surface) of each boundary element, in the order of
/// RawMesh::boundary_points; 0 if the file names none. Throws as read_msh().
std::vector<int> read_boundary_entities(const std::filesystem::path& file);

}  // namespace couplet::mesh
