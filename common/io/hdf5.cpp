// SPDX-License-Identifier: Apache-2.0
#include "common/io/hdf5.hpp"

#include <algorithm>
#include <exception>

#include "common/base/own_file.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io::hdf5 {
namespace {

herr_t keep_first_reason(unsigned, const H5E_error2_t* entry, void* text) {
  auto& reason = *static_cast<std::string*>(text);
  if (reason.empty() && entry->desc != nullptr) reason = entry->desc;
  return 0;
}

// Throws Error with HDF5's reason if `id` is negative.
Handle checked(hid_t id, herr_t (*close)(hid_t), const char* action, const std::string& what) {
  if (id < 0) throw Error("HDF5 could not {} '{}' ({}).", action, what, reason());
  return {id, close};
}

void check(herr_t status, const char* action, const std::string& what) {
  if (status < 0) throw Error("HDF5 could not {} '{}' ({}).", action, what, reason());
}

/// Closes a file that is being written, unless an exception is on its way: closing is collective and the
/// other ranks may be elsewhere, and HDF5 crashes if it flushes again after a failed write.
herr_t close_unless_failing(hid_t file) { return std::uncaught_exceptions() > 0 ? 0 : H5Fclose(file); }

Handle file_access(MPI_Comm comm) {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // A viewer that has the file open must not stop the run.
  H5Pset_file_locking(access, false, true);
  if (parallel::comm_size(comm) > 1) {
    H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL);
    H5Pset_all_coll_metadata_ops(access, true);
    H5Pset_coll_metadata_write(access, true);
  }
  return access;
}

Handle file_space(const RowSpan& rows) {
  const hsize_t size[2] = {rows.total, rows.width};
  return {H5Screate_simple(rows.width == 1 ? 1 : 2, size, nullptr), H5Sclose};
}

void select(const Handle& space, const RowSpan& rows) {
  const hsize_t start[2] = {rows.first, 0}, count[2] = {rows.count, rows.width};
  if (rows.count == 0)
    H5Sselect_none(space);
  else
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr);
}

Handle memory_space(const RowSpan& rows) {
  const hsize_t size[1] = {rows.count * rows.width};
  Handle space(H5Screate_simple(1, size, nullptr), H5Sclose);
  if (rows.count == 0) H5Sselect_none(space);
  return space;
}

// Returns true if several ranks opened the file of this object together.
bool is_shared(hid_t object) {
  const Handle file(H5Iget_file_id(object), H5Fclose);
  const Handle access(H5Fget_access_plist(file), H5Pclose);
  return H5Pget_driver(access) == H5FD_MPIO;
}

/// Layout of a table. Compressed tables are stored in blocks of rows with sorted bytes (shuffle), since
/// neighboring values differ only in their last bytes.
Handle layout_of(const RowSpan& rows) {
  constexpr std::uint64_t block = 1 << 15;  // values
  Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (rows.compression == 0 || rows.total == 0) return layout;
  const hsize_t extent[2] = {std::clamp<hsize_t>(block / rows.width, 1, rows.total), rows.width};
  H5Pset_chunk(layout, rows.width == 1 ? 1 : 2, extent);
  H5Pset_shuffle(layout);
  H5Pset_deflate(layout, unsigned(rows.compression));
  return layout;
}

void write_any(hid_t place, const std::string& path, const RowSpan& rows, hid_t type, const void* values) {
  const Quiet quiet;
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Handle space = file_space(rows);
  const Handle layout = layout_of(rows);
  Handle table = checked(H5Dcreate2(place, path.c_str(), type, space, links, layout, H5P_DEFAULT), H5Dclose,
                         "create the table", path);
  if (rows.total == 0) return;
  select(space, rows);
  const Handle memory = memory_space(rows);
  const Handle transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
  if (is_shared(table)) H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  check(H5Dwrite(table, type, memory, space, transfer, values), "write the table", path);
  // Closing flushes what HDF5 holds back.
  check(H5Dclose(table.release()), "write the table", path);
}

}  // namespace

Quiet::Quiet() {
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Quiet::~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

std::string reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first_reason, &text);
  return text.empty() ? "no reason given" : text;
}

Handle create_file(MPI_Comm comm, const std::filesystem::path& file) {
  base::own_file(file);
  const Quiet quiet;
  return checked(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, file_access(comm)), close_unless_failing,
                 "create", file.string());
}

Handle open_file_to_write(MPI_Comm comm, const std::filesystem::path& file) {
  const Quiet quiet;
  return checked(H5Fopen(file.c_str(), H5F_ACC_RDWR, file_access(comm)), close_unless_failing, "open",
                 file.string());
}

void close_file(MPI_Comm comm, Handle& file, const std::filesystem::path& name) {
  const Quiet quiet;
  std::string trouble;
  if (H5Fflush(file, H5F_SCOPE_GLOBAL) < 0 || H5Fclose(file.release()) < 0)
    trouble = fmt::format("Cannot write '{}' ({}). Is the disk full?", name.string(), reason());
  parallel::throw_together(comm, trouble);
}

Handle open_written(hid_t place, const std::string& table) {
  const Quiet quiet;
  return checked(H5Dopen2(place, table.c_str(), H5P_DEFAULT), H5Dclose, "open the table", table);
}

void remove(hid_t place, const std::string& path) {
  const Quiet quiet;
  check(H5Ldelete(place, path.c_str(), H5P_DEFAULT), "remove", path);
}

bool exists(hid_t place, const std::string& path) {
  const Quiet quiet;
  // H5Lexists requires every parent group to exist.
  for (std::size_t slash = path.find('/', 1); slash != std::string::npos; slash = path.find('/', slash + 1))
    if (H5Lexists(place, path.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
  return H5Lexists(place, path.c_str(), H5P_DEFAULT) > 0;
}

Handle make_group(hid_t place, const std::string& path) {
  const Quiet quiet;
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  return checked(H5Gcreate2(place, path.c_str(), links, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                 "create the group", path);
}

RowSpan distribute_rows(MPI_Comm comm, std::size_t count, std::size_t width) {
  const auto mine = static_cast<GlobalIndex>(count);
  return {static_cast<std::uint64_t>(parallel::exclusive_scan(comm, mine)), count,
          static_cast<std::uint64_t>(parallel::sum(comm, mine)), width};
}

void write_table(hid_t place, const std::string& path, const RowSpan& rows, const double* values) {
  write_any(place, path, rows, H5T_NATIVE_DOUBLE, values);
}

void write_table(hid_t place, const std::string& path, const RowSpan& rows, const std::int64_t* values) {
  write_any(place, path, rows, H5T_NATIVE_INT64, values);
}

void write_attribute(hid_t object, const std::string& name, double value) {
  const Quiet quiet;
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute =
      checked(H5Acreate2(object, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
              "create the attribute", name);
  check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value), "write the attribute", name);
}

void write_attribute(hid_t object, const std::string& name, const std::string& text) {
  const Quiet quiet;
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(text.size(), 1));
  const Handle attribute = checked(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                                   H5Aclose, "create the attribute", name);
  check(H5Awrite(attribute, type, text.c_str()), "write the attribute", name);
}

}  // namespace couplet::io::hdf5
