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

namespace couplet::mesh {

/// A .msh file mapped into memory and read from front to back. Pages that have been read are given back, so that a rank
/// never holds a large file.
class MshCursor {
 public:
  /// Throws Error if it cannot be opened.
  explicit MshCursor(std::filesystem::path file);
  ~MshCursor();
  MshCursor(const MshCursor&) = delete;

  bool binary = false;

  /// Throws Error "file:line: ..." (for binary files "file, byte n, in $Section: ...").
  [[noreturn]] void fail(const std::string& what) const;
  const std::filesystem::path& file() const { return file_; }

  std::size_t place() const { return at_; }
  /// Goes to a place in a section.
  void go_to(std::size_t place, const std::string& section);
  bool at_end() const { return at_ >= text_.size(); }
  /// The rest of the current line, trimmed; the cursor goes to the next line.
  std::string line();
  /// Next line that is not empty and starts a section: "Nodes" for "$Nodes"; "" at the end of the file.
  std::string next_section();
  /// To behind "$End<section>".
  void skip_section();
  void end_section();

  /// Numbers: words of text or bytes, as the file is.
  int integer() { return binary ? raw<int>() : static_cast<int>(text_integer()); }
  std::size_t size() { return binary ? raw<std::size_t>() : static_cast<std::size_t>(text_integer()); }
  double real() {
    const double value = binary ? raw<double>() : text_real();
    if (!std::isfinite(value)) fail(fmt::format("Expected a finite number, found '{}'.", value));
    return value;
  }
  /// Numbers that are text in binary files too.
  long text_integer();
  double text_real();
  template <class T>
  T raw() {
    if (text_.size() - at_ < sizeof(T)) fail(incomplete);
    T value;
    std::memcpy(&value, text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  /// Passes over numbers of so many bytes, or as many words.
  void skip(std::size_t numbers, std::size_t bytes = 8);
  /// A count of things that take at least a byte each: refuses what the file cannot hold.
  std::size_t count() { return checked(size()); }
  std::size_t text_count() { return checked(static_cast<std::size_t>(text_integer())); }
  std::string quoted();

 private:
  static constexpr const char* incomplete = "The file ends here in the middle of its data. It is incomplete.";
  std::string_view word();
  std::size_t checked(std::size_t n) const;
  void give_back_pages();

  std::filesystem::path file_;
  std::string_view text_;  // the mapping
  std::size_t at_ = 0, given_back_ = 0;
  std::string section_;
};

/// This rank's block of the mesh in a .msh, which the first `holders` ranks read; the order is that of read_msh(). Throws Error
/// with file and line. Collective.
MeshBlock read_msh_block(MPI_Comm comm, const std::filesystem::path& file, int holders);

/// Tells whether a .msh has elements of this dimension. False for a file without any, or one that is none.
bool has_cells(const std::filesystem::path& file, int dim);

/// The elementary entity (gmsh's tag of a curve or surface of the drawing) of each boundary element that read_msh() gives
/// for this file, in the order of RawMesh::boundary_points; 0 where the file names none. Throws as read_msh().
std::vector<int> read_boundary_entities(const std::filesystem::path& file);

}  // namespace couplet::mesh
