// SPDX-License-Identifier: Apache-2.0
// spoil_hdf5 FILE attribute|table|long|external|cut NAME N: makes what is called NAME something else, of N values. Of a file in a checkpoint's
// folder the digests are made to fit again.
#include <hdf5.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "common/io/checkpoint_set.hpp"

namespace {

void spoil(hid_t file, const std::string& how, const char* name, hsize_t n) {
  const std::vector<double> values(n, 1e9);
  const hid_t space = H5Screate_simple(1, &n, nullptr), links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  if (how == "attribute") {
    H5Adelete(file, name);
    const hid_t attribute = H5Acreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data());
    H5Aclose(attribute);
  } else {
    H5Ldelete(file, name, H5P_DEFAULT);
    if (how == "external") H5Lcreate_external("/etc/hostname", "/x", file, name, links, H5P_DEFAULT);
    if (how == "table") {
      const hid_t table = H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, links, H5P_DEFAULT, H5P_DEFAULT);
      H5Dwrite(table, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
      H5Dclose(table);
    }
  }
  H5Pclose(links);
  H5Sclose(space);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 64;
  const std::filesystem::path path = argv[1];
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  if (file < 0) return 1;
  spoil(file, argv[2], argv[3], std::strtoull(argv[4], nullptr, 10));
  H5Fclose(file);
  const std::filesystem::path folder = path.parent_path();
  if (const auto set = couplet::io::read_checkpoint_set(folder))
    couplet::io::finish_checkpoint_set(folder, set->stamp);
  return 0;
}
