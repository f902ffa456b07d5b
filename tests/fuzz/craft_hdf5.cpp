// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/craft_hdf5.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace couplet::fuzz {
namespace {

using Type = CraftedValue::Type;
using Store = CraftedValue::Store;
using Link = CraftedValue::Link;

/// New ids of types, to be closed.
hid_t type_of(const CraftedValue& v) {
  switch (v.type) {
    case Type::f32:
      return H5Tcopy(H5T_IEEE_F32LE);
    case Type::i64:
      return H5Tcopy(H5T_STD_I64LE);
    case Type::u8:
      return H5Tcopy(H5T_STD_U8LE);
    case Type::big_endian:
      return H5Tcopy(H5T_IEEE_F64BE);
    case Type::text:
    case Type::long_text: {
      const hid_t type = H5Tcopy(H5T_C_S1);
      H5Tset_size(type, std::max<std::size_t>(1, v.text.size()));
      return type;
    }
    case Type::text_of_any_length: {
      const hid_t type = H5Tcopy(H5T_C_S1);
      H5Tset_size(type, H5T_VARIABLE);
      return type;
    }
    case Type::compound: {
      const hid_t type = H5Tcreate(H5T_COMPOUND, 24);
      for (const char* name : {"a", "b", "c"})
        H5Tinsert(type, name, std::size_t(name[0] - 'a') * 8, H5T_NATIVE_DOUBLE);
      return type;
    }
    case Type::array: {
      const hsize_t n[1] = {64};
      return H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, n);
    }
    case Type::reference:
      return H5Tcopy(H5T_STD_REF_OBJ);
    case Type::enumeration: {
      const hid_t type = H5Tenum_create(H5T_NATIVE_INT);
      const int one = 1;
      H5Tenum_insert(type, "one", &one);
      return type;
    }
    case Type::opaque:
      return H5Tcreate(H5T_OPAQUE, 4096);
    case Type::odd_float: {
      const hid_t type = H5Tcopy(H5T_IEEE_F64LE);
      H5Tset_size(type, 64);
      return type;
    }
    default:
      return H5Tcopy(H5T_IEEE_F64LE);
  }
}

std::uint64_t count_of(const std::vector<std::uint64_t>& size) {
  std::uint64_t n = 1;
  for (const std::uint64_t s : size)
    n = s == 0 ? 0 : (n > (std::uint64_t(1) << 40) / s ? std::uint64_t(1) << 40 : n * s);
  return n;
}

/// The values in memory as the type has them: numbers as they are, all else as bytes.
std::vector<char> bytes_of(const CraftedValue& v, hid_t type) {
  const std::size_t n = std::size_t(count_of(v.size)), each = H5Tget_size(type);
  std::vector<char> bytes(std::max<std::size_t>(1, n) * each, 0);
  if (v.type == Type::text || v.type == Type::long_text) {
    std::copy_n(v.text.begin(), std::min(v.text.size(), bytes.size()), bytes.begin());
    return bytes;
  }
  if (v.type != Type::f64 && v.type != Type::f32 && v.type != Type::i64 && v.type != Type::u8 &&
      v.type != Type::big_endian)
    return bytes;
  if (v.type == Type::i64 && !v.integers.empty()) {
    std::copy_n(reinterpret_cast<const char*>(v.integers.data()),
                std::min(bytes.size(), 8 * v.integers.size()), bytes.data());
    return bytes;
  }
  std::vector<double> values(std::max<std::size_t>(1, n), 0.0);
  std::copy_n(v.values.begin(), std::min(values.size(), v.values.size()), values.begin());
  values.resize(std::max(values.size(), bytes.size() / sizeof(double) + 1));
  H5Tconvert(H5T_NATIVE_DOUBLE, type, std::max<std::size_t>(1, n), values.data(), nullptr, H5P_DEFAULT);
  std::copy_n(reinterpret_cast<const char*>(values.data()), bytes.size(), bytes.data());
  return bytes;
}

hid_t space_of(const CraftedValue& v) {
  if (v.type == Type::none) return H5Screate(H5S_NULL);
  if (v.size.empty()) return H5Screate(H5S_SCALAR);
  std::vector<hsize_t> size(v.size.begin(), v.size.end());
  return H5Screate_simple(int(size.size()), size.data(), nullptr);
}

void write_attribute(hid_t object, const CraftedValue& v) {
  const std::size_t slash = v.path.rfind('/');
  const std::string name = slash == std::string::npos ? v.path : v.path.substr(slash + 1);
  const hid_t type = type_of(v), space = space_of(v);
  const hid_t attribute = H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
  const char* text = v.text.c_str();
  if (attribute >= 0 && v.type == Type::text_of_any_length && v.size.empty())
    H5Awrite(attribute, type, &text);
  else if (attribute >= 0 && v.type != Type::none && v.type != Type::text_of_any_length &&
           count_of(v.size) <= 8000)
    H5Awrite(attribute, type, bytes_of(v, type).data());
  if (attribute >= 0) H5Aclose(attribute);
  H5Sclose(space), H5Tclose(type);
}

/// How a table is stored; -1: by default.
hid_t storage_of(const CraftedValue& v) {
  const hid_t storage = H5Pcreate(H5P_DATASET_CREATE);
  std::vector<hsize_t> chunk;
  for (const std::uint64_t n : v.size)
    chunk.push_back(std::clamp<hsize_t>(n, 1, v.store == Store::bomb ? 1u << 22 : 64));
  const int rank = int(chunk.size());
  const bool simple = rank > 0 && v.type != Type::none;
  switch (v.store) {
    case Store::compact:
      H5Pset_layout(storage, H5D_COMPACT);
      break;
    case Store::chunked:
      if (simple) H5Pset_chunk(storage, rank, chunk.data());
      break;
    case Store::deflated:
    case Store::bomb:
      if (simple)
        H5Pset_chunk(storage, rank, chunk.data()), H5Pset_shuffle(storage), H5Pset_deflate(storage, 9);
      break;
    case Store::unknown_filter: {
      const unsigned values[1] = {1};
      if (simple)
        H5Pset_chunk(storage, rank, chunk.data()),
            H5Pset_filter(storage, 32000, H5Z_FLAG_OPTIONAL, 1, values);
      break;
    }
    case Store::other_file:
      if (simple) H5Pset_external(storage, "../outside/values.bin", 0, H5F_UNLIMITED);
      break;
    case Store::virtual_table: {
      const hid_t space = space_of(v);
      if (simple) H5Pset_virtual(storage, space, "../outside/other.h5", "/frequency", space);
      H5Sclose(space);
      break;
    }
    default:
      break;
  }
  return storage;
}

void write_table(hid_t file, const CraftedValue& v, hid_t links) {
  const hid_t type = type_of(v), space = space_of(v), storage = storage_of(v);
  const hid_t table = H5Dcreate2(file, v.path.c_str(), type, space, links, storage, H5P_DEFAULT);
  const bool is_written = v.store != Store::unwritten && v.store != Store::other_file &&
                          v.store != Store::virtual_table && v.type != Type::none &&
                          v.type != Type::text_of_any_length && v.type != Type::reference;
  if (table >= 0 && is_written && count_of(v.size) * H5Tget_size(type) <= (std::size_t(1) << 27))
    H5Dwrite(table, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes_of(v, type).data());
  if (table >= 0) H5Dclose(table);
  H5Pclose(storage), H5Sclose(space), H5Tclose(type);
}

void write_value(hid_t file, const CraftedValue& v, hid_t links) {
  switch (v.link) {
    case Link::missing:
      return;
    case Link::soft:
      H5Lcreate_soft("/elsewhere", file, v.path.c_str(), links, H5P_DEFAULT);
      return;
    case Link::soft_loop:
      H5Lcreate_soft(("/" + v.path).c_str(), file, v.path.c_str(), links, H5P_DEFAULT);
      return;
    case Link::external:
      H5Lcreate_external("../outside/other.h5", "/frequency", file, v.path.c_str(), links, H5P_DEFAULT);
      return;
    case Link::group: {
      const hid_t group = H5Gcreate2(file, v.path.c_str(), links, H5P_DEFAULT, H5P_DEFAULT);
      if (group >= 0) H5Gclose(group);
      return;
    }
    case Link::cycle:
      H5Lcreate_hard(file, "/", file, v.path.c_str(), links, H5P_DEFAULT);
      return;
    default:
      write_table(file, v, links);
      if (v.link == Link::twice)
        H5Lcreate_hard(file, v.path.c_str(), file, (v.path + "-again").c_str(), links, H5P_DEFAULT);
  }
}

template <class T>
T any_of(std::initializer_list<T> list, Dice& dice) {
  return *(list.begin() + std::ptrdiff_t(dice.below(list.size())));
}

void change_size(CraftedValue& v, Dice& dice) {
  const std::uint64_t huge = any_of<std::uint64_t>(
      {0, 1, 2, 6, 2000, 1u << 20, std::uint64_t(1) << 31, std::uint64_t(1) << 40}, dice);
  switch (dice.below(5)) {
    case 0:
      v.size.assign(dice.below(6), 2);
      break;
    case 1:
      v.size.push_back(1 + dice.below(3));
      break;
    case 2:
      if (v.size.empty()) v.size.push_back(1);
      v.size[dice.below(v.size.size())] += dice.one_in(2) ? 1 : std::uint64_t(-1);
      for (std::uint64_t& n : v.size) n = std::min<std::uint64_t>(n, std::uint64_t(1) << 40);
      break;
    case 3:
      v.size = {huge};
      break;
    default:
      if (!v.size.empty()) v.size[0] = huge;
  }
  // Nothing that this test itself could not write.
  if (count_of(v.size) > (1u << 20) && v.store == Store::plain)
    v.store = any_of({Store::unwritten, Store::chunked, Store::bomb}, dice);
}

void change_number(CraftedValue& v, Dice& dice) {
  if (!v.integers.empty())
    v.integers[dice.below(v.integers.size())] = any_of<std::int64_t>(
        {-1, 0, 1, 1000000, std::int64_t(1) << 31, std::numeric_limits<std::int64_t>::max()}, dice);
  if (v.values.empty()) return;
  v.values[dice.below(v.values.size())] =
      any_of({-1., 0., 1e300, -1e300, 4e9, 1e18, 0.5, double(NAN), double(INFINITY)}, dice);
}

}  // namespace

void write(const std::filesystem::path& file, const CraftedFile& content) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t id = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  for (const CraftedValue& v : content)
    if (!v.is_attribute) write_value(id, v, links);
  for (const CraftedValue& v : content)
    if (v.is_attribute && v.link != Link::missing) write_attribute(id, v);
  H5Pclose(links);
  H5Fclose(id);
}

CraftedFile mutate(CraftedFile content, Dice& dice) {
  for (std::size_t n = 1 + dice.below(3); n > 0; --n) {
    CraftedValue& v = content[dice.below(content.size())];
    switch (dice.below(6)) {
      case 0:
        v.type = Type(dice.below(std::size_t(Type::none) + 1));
        if (v.type == Type::long_text) v.text.assign(any_of<std::size_t>({257, 5000, 60000}, dice), 'x');
        break;
      case 1:
        change_size(v, dice);
        break;
      case 2:
        v.store = Store(dice.below(std::size_t(Store::virtual_table) + 1));
        if (v.store == Store::bomb && v.size.size() < 2) v.size.assign(1, 1u << 24);
        break;
      case 3:
        v.link = Link(dice.below(std::size_t(Link::twice) + 1));
        break;
      case 4:
        change_number(v, dice);
        break;
      default:
        v.text = mutate_bytes(v.text, dice);
        if (!v.is_attribute) change_number(v, dice);
    }
  }
  return content;
}

void damage_bytes(const std::filesystem::path& file, Dice& dice) {
  std::string text = read_file(file);
  if (text.empty()) return;
  // What HDF5 keeps of its own lies at the beginning of small files and around the tables' headers.
  for (std::size_t n = 1 + dice.below(8); n > 0; --n) {
    const std::size_t range = dice.one_in(2) ? std::min<std::size_t>(text.size(), 2048) : text.size(),
                      at = dice.below(range);
    if (dice.one_in(3))
      text[at] = char(dice.below(256));
    else
      text[at] = any_of<char>({0, 1, 2, 4, 8, 16, 127, char(128), char(255)}, dice);
  }
  if (dice.one_in(10)) text.resize(dice.below(text.size()));
  write_file(file, text);
}

}  // namespace couplet::fuzz
