// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/load.hpp"
#include "support.hpp"

namespace couplet::load_test {
using namespace mesh;
using namespace parallel;

using ::testing::HasSubstr;

/// One folder for all ranks.
class LoadMesh : public ::testing::Test {
 protected:
  LoadMesh() {
    std::string name = own_.path.string();
    broadcast(MPI_COMM_WORLD, name);
    folder = name;
    caches = folder / "cache";
    setenv("XDG_CACHE_HOME", caches.c_str(), 1);
  }
  ~LoadMesh() override { MPI_Barrier(MPI_COMM_WORLD); }
  std::filesystem::path write(const std::string& name, const std::string& text) {
    if (comm_rank(MPI_COMM_WORLD) == 0) std::ofstream(folder / name) << text;
    MPI_Barrier(MPI_COMM_WORLD);
    return folder / name;
  }
  static std::size_t files_in(const std::filesystem::path& of) {
    const std::filesystem::directory_iterator all(of);
    return std::size_t(
        std::count_if(begin(all), end(all), [](const auto& e) { return e.is_regular_file(); }));
  }
  static std::string error(const std::filesystem::path& file, int dim) {
    return support::error_of([&] { load_mesh(MPI_COMM_WORLD, file, dim); });
  }

  std::filesystem::path folder, caches;

 private:
  test::TemporaryFolder own_;
};

const std::string square =
    "Point(1) = {0,0,0,h}; Point(2) = {1,0,0,h}; Point(3) = {1,1,0,h}; Point(4) = {0,1,0,h};\n"
    "Line(1) = {1,2}; Line(2) = {2,3}; Line(3) = {3,4}; Line(4) = {4,1};\n"
    "Curve Loop(1) = {1,2,3,4}; Plane Surface(1) = {1};\n"
    "Physical Curve(\"around\") = {1,2,3,4}; Physical Surface(\"inside\") = {1};\n";

TEST_F(LoadMesh, reads_a_file_on_any_number_of_ranks) {
  const auto [mesh, geometry] = load_mesh(MPI_COMM_WORLD, test::data / "solid_41_binary.msh", 3);
  double volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume += geometry.volume[c];
  EXPECT_NEAR(sum(MPI_COMM_WORLD, volume), 2.5, 1e-13);
  EXPECT_EQ(mesh.zones, (std::vector<std::string>{"lower", "upper"}));
}

TEST_F(LoadMesh, meshes_a_geo_once_even_if_all_ask_at_the_same_time) {
  const auto geo = write("square.geo", "h = 0.3;\n" + square);
  const auto first = mesh_geo(geo, 2);
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_EQ(files_in(folder), 1u) << "only the .geo";
  EXPECT_EQ(files_in(caches / "couplet/meshes"), 1u) << "nothing temporary";
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(mesh_geo(geo, 2), first);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "") << "not meshed again";
  EXPECT_THAT(first.filename().string(), ::testing::MatchesRegex("square\\.[0-9a-f]+\\.cache\\.msh"));
  const auto [mesh, geometry] = load_mesh(MPI_COMM_WORLD, geo, 2);
  EXPECT_NE(mesh.find_patch("around"), nullptr);
}

TEST_F(LoadMesh, meshes_used_long_ago_are_removed_beyond_4_gigabytes) {
  const auto kept = caches / "couplet/meshes";
  if (comm_rank(MPI_COMM_WORLD) == 0) {
    std::filesystem::create_directories(kept);
    int days = 3;
    for (const char* name : {"oldest.msh", "newer.msh", "other.txt"}) {
      std::ofstream(kept / name) << "x";
      std::filesystem::resize_file(kept / name, std::uintmax_t(3) << 30);  // sparse
      std::filesystem::last_write_time(
          kept / name, std::filesystem::file_time_type::clock::now() - std::chrono::hours(24 * days--));
    }
  }
  const auto mesh = [&](const char* name) {
    load_mesh(MPI_COMM_WORLD, write(name, "h = 0.5;\n" + square), 2);
    MPI_Barrier(MPI_COMM_WORLD);
  };
  mesh("one.geo");
  EXPECT_FALSE(std::filesystem::exists(kept / "oldest.msh"));
  EXPECT_TRUE(std::filesystem::exists(kept / "newer.msh"));
  EXPECT_TRUE(std::filesystem::exists(kept / "other.txt"));
  EXPECT_EQ(files_in(kept), 3u);
}

/// A machine that went down while it wrote: no fault of the user's, who has nothing to mend.
TEST_F(LoadMesh, a_truncated_cache_is_made_anew) {
  const auto geo = write("square.geo", "h = 0.3;\n" + square);
  const GlobalIndex cells = load_mesh(MPI_COMM_WORLD, geo, 2).mesh.cells.n_global();
  const auto cache = mesh_geo(geo, 2);
  const auto size = std::filesystem::file_size(cache);
  for (const auto kept : {std::uintmax_t(0), size / 3, size - 20}) {
    MPI_Barrier(MPI_COMM_WORLD);
    if (comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::resize_file(cache, kept);
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_EQ(load_mesh(MPI_COMM_WORLD, geo, 2).mesh.cells.n_global(), cells)
        << kept << " of " << size << " bytes left";
    EXPECT_EQ(std::filesystem::file_size(cache), size);
  }
}

/// A number changed in the middle, another mesh under this name, one that no Couplet wrote: each would be read without complaint.
TEST_F(LoadMesh, a_cache_with_another_digest_is_made_anew) {
  const auto geo = write("square.geo", "h = 0.3;\n" + square),
             other = write("other.geo", "h = 0.6;\n" + square);
  const GlobalIndex cells = load_mesh(MPI_COMM_WORLD, geo, 2).mesh.cells.n_global();
  load_mesh(MPI_COMM_WORLD, other, 2);
  const auto cache = mesh_geo(geo, 2);
  const auto content = [](const std::filesystem::path& file) {
    std::ifstream in(file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string whole = content(cache), foreign = content(mesh_geo(other, 2));
  std::string moved = whole;
  moved.replace(moved.find("\n0 1 0\n"), 7, "\n0 9 0\n");
  const std::string unsealed = whole.substr(0, whole.find("$Comments"));
  for (const std::string& text : {moved, foreign, unsealed}) {
    MPI_Barrier(MPI_COMM_WORLD);
    if (comm_rank(MPI_COMM_WORLD) == 0) {
      std::ofstream(cache) << text;
      ::testing::internal::CaptureStdout();
    }
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_EQ(load_mesh(MPI_COMM_WORLD, geo, 2).mesh.cells.n_global(), cells);
    if (comm_rank(MPI_COMM_WORLD) == 0) {
      const std::string log = ::testing::internal::GetCapturedStdout();
      EXPECT_THAT(log, HasSubstr("is damaged or was not written by Couplet"));
    }
    EXPECT_EQ(content(cache), whole);
  }
}

TEST_F(LoadMesh, meshes_again_when_the_geo_or_a_file_it_includes_changed) {
  write("size.geo", "h = 0.5;\n");
  const auto geo = write("square.geo", "Include \"size.geo\";\n" + square);
  const GlobalIndex coarse = load_mesh(MPI_COMM_WORLD, geo, 2).mesh.cells.n_global();
  write("size.geo", "h = 0.2;\n");
  EXPECT_GT(load_mesh(MPI_COMM_WORLD, geo, 2).mesh.cells.n_global(), 2 * coarse);
}

TEST_F(LoadMesh, a_parameter_replaces_the_constant_of_the_geo) {
  const auto geo =
      write("square.geo",
            "/* DefineConstant [ no = 1 ]; */ DefineConstant [ h = {0.5, Name \"size\"}, k = 1 ]; "
            "// DefineConstant [ nor = 1 ]\n" +
                square);
  const GlobalIndex coarse = load_mesh(MPI_COMM_WORLD, geo, 2).mesh.cells.n_global();
  EXPECT_EQ(load_mesh(MPI_COMM_WORLD, geo, 2, {{"h", 0.5}}).mesh.cells.n_global(), coarse);
  EXPECT_GT(load_mesh(MPI_COMM_WORLD, geo, 2, {{"h", 0.2}}).mesh.cells.n_global(), 2 * coarse);
  EXPECT_EQ(load_mesh(MPI_COMM_WORLD, geo, 2).mesh.cells.n_global(), coarse) << "the cache keeps them apart";
}

TEST_F(LoadMesh, a_parameter_that_nobody_takes_is_an_error) {
  const auto error = [](const std::filesystem::path& file, const MeshParameters& parameters) {
    return support::error_of([&] { load_mesh(MPI_COMM_WORLD, file, 2, parameters); });
  };
  const auto geo = write("square.geo",
                         "/* DefineConstant [ no = 1 ]; */ DefineConstant [ size = 0.5, k = 1 ];\n"
                         "h = size;\n" +
                             square);
  EXPECT_EQ(error(geo, {{"sise", 1}}),
            "The geometry file '" + geo.string() +
                "' defines no parameter 'sise' with DefineConstant. Did you mean 'size'?");
  EXPECT_THAT(error(geo, {{"no", 1}}), HasSubstr("Valid names: size, k."));
  EXPECT_THAT(
      error(write("fixed.geo", "h = 0.5;\n" + square), {{"h", 1}}),
      HasSubstr("defines no parameters, so 'mesh-parameters' cannot set 'h'. Declare names that are set "
                "from outside as 'DefineConstant [ h = 1 ];'."));
  EXPECT_THAT(error(test::data / "plane_41_ascii.msh", {{"h", 1}}),
              HasSubstr("is already meshed, so 'mesh-parameters' cannot change it."));
}

// gmsh makes 3 cells of -3, 2 of 2.5 and triangles of 0, without a word.
TEST_F(LoadMesh, a_number_of_cells_that_is_none_is_refused) {
  const auto geo = write(
      "counts.geo",
      "DefineConstant [ n = 4, half = 8, shift = 1 ];\n"
      "Point(1) = {0, 0, 0, 1}; Point(2) = {1, 0, 0, 1}; Line(1) = {1, 2}; Transfinite Curve {1} = n + 1 Using "
      "Bump shift;\n"
      "out() = Extrude {0, 1, 0} { Curve{1}; Layers {half / 2}; Recombine; };\n"
      "Physical Curve(\"floor\") = {1}; Physical Curve(\"rest\") = {out(0), out(2), out(3)};\n"
      "Physical Surface(\"body\") = {out(1)};\n");
  const auto error = [&](const MeshParameters& parameters) {
    return support::error_of([&] { load_mesh(MPI_COMM_WORLD, geo, 2, parameters); });
  };
  for (const double value : {-3.0, 0.0, 2.5, 1e9})
    EXPECT_THAT(error({{"n", value}}), HasSubstr("'n' is a number of cells in the geometry file")) << value;
  EXPECT_THAT(error({{"half", -8.0}}), HasSubstr("it must be a number above 0"));
  EXPECT_EQ(error({{"n", 3}, {"half", 5}, {"shift", 0.5}}), "");
}

TEST_F(LoadMesh, errors_on_rank_0_are_thrown_on_every_rank) {
  EXPECT_EQ(error(folder / "none.msh", 3),
            "The mesh file '" + (folder / "none.msh").string() +
                "' does not exist. The path is relative to the folder of the YAML file.");
  EXPECT_THAT(
      error(write("mesh.stl", ""), 3),
      HasSubstr(
          "is not a .msh, .geo, .inp, .su2, .bdf, .unv, .med, .exo or .cgns file. Export the mesh from the program "
          "that made it, in a format that keeps the names of its parts: .su2 (markers)"));
  // gmsh would take both for scripts.
  EXPECT_THAT(error(write("mesh.vtk", ""), 3), HasSubstr("is not a .msh"));
  // Fluent's are in ASCII or binary, and begin alike.
  for (const char* text : {"(0 \"Fluent mesh\")\n(2 3)\n", "\n(3010 (1 1 8 1 3)\n("})
    EXPECT_THAT(error(write("fluent.msh", text), 3),
                HasSubstr("fluent.msh' is a file of Fluent, which is not supported. Export"));
  std::filesystem::create_directories(folder / "constant/polyMesh");
  for (const char* name : {"constant/polyMesh", "constant", "."})
    EXPECT_THAT(error(folder / name, 3), HasSubstr("' is a file of OpenFOAM, which is not supported. Export"))
        << name;
  EXPECT_THAT(error(folder / "other", 3), HasSubstr("does not exist"));
  EXPECT_THAT(error(write("mesh.inp", ""), 3), HasSubstr("mesh.inp: the deck has no solid elements"));
  EXPECT_THAT(error(test::data / "plane_41_ascii.msh", 3),
              HasSubstr("is 2-dimensional, but the case sets 'dimension: 3'."));
  EXPECT_THAT(error(write("bad.msh", "hello"), 3),
              HasSubstr("bad.msh:1: Expected a section such as $Nodes here"));
}

TEST_F(LoadMesh, reads_unv_with_its_groups_as_patches_and_scales_lengths) {
  const std::filesystem::path copy = folder / "millimetres.unv";
  if (comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::copy(test::data / "millimetres.unv", copy);
  MPI_Barrier(MPI_COMM_WORLD);
  const auto [mesh, geometry] = load_mesh(MPI_COMM_WORLD, copy, 2, {}, {}, {}, false, 0.001);
  EXPECT_EQ(mesh.cells.n_global(), 4);
  ASSERT_EQ(mesh.patches.size(), 2u);
  EXPECT_NE(mesh.find_patch("floor"), nullptr);
  EXPECT_NE(mesh.find_patch("sides"), nullptr);
  double volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume += geometry.volume[c];
  EXPECT_NEAR(sum(MPI_COMM_WORLD, volume), 1, 1e-12);  // 1000 mm x 1000 mm x 1 m
  EXPECT_THAT(support::error_of([&] {
                load_mesh(MPI_COMM_WORLD, copy, 2, {{"h", 1}});
              }),
              HasSubstr("'mesh-parameters' cannot change it"));
}

TEST_F(LoadMesh, a_msh_of_another_version_is_converted_by_gmsh) {
  std::ifstream in(test::data / "plane_22_ascii.msh");
  std::string text(std::istreambuf_iterator<char>(in), {});
  text.replace(text.find("2.2 0 8"), 7, "2 0 8");
  for (const char* name : {"1 11 \"", "1 12 \"", "1 13 \"", "2 14 \"", "2 15 \""})
    text.erase(text.find(name), 2);  // the dimension
  const std::string oldest =
      "$NOD\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$ENDNOD\n"
      "$ELM\n3\n1 3 1 1 4 1 2 5 4\n2 3 1 1 4 2 3 6 5\n3 1 7 7 2 4 1\n$ENDELM\n";
  const auto of_file = [&](const std::string& name, const std::string& content) {
    const auto [mesh, geometry] = load_mesh(MPI_COMM_SELF, write(name, content), 2);
    std::map<std::string, double> lengths;
    for (const Patch& patch : mesh.patches)
      for (Index f = patch.first; f < patch.first + patch.count; ++f)
        lengths[patch.name] += geometry.face_area[f].norm();
    return std::pair(mesh.cells.n_global(), lengths);
  };
  const auto [cells, lengths] = of_file("version-2.msh", text);
  EXPECT_EQ(cells, 18);
  EXPECT_EQ(lengths.size(), 3u);
  EXPECT_DOUBLE_EQ(lengths.at("inlet"), 1);
  const auto [two, sides] = of_file("version-1.msh", oldest);
  EXPECT_EQ(two, 2);
  EXPECT_EQ(sides, (std::map<std::string, double>{{"physical_7", 1}, {"rest", 5}}));
}

TEST_F(LoadMesh, elements_of_second_order_are_reduced_to_their_corners) {
  const auto geo = write("second.geo", "h = 0.3;\n" + square + "Mesh.ElementOrder = 2;\n");
  const auto [mesh, geometry] = load_mesh(MPI_COMM_SELF, geo, 2);
  const auto first = load_mesh(MPI_COMM_SELF, write("first.geo", "h = 0.3;\n" + square), 2);
  EXPECT_EQ(mesh.cells.n_global(), first.mesh.cells.n_global());
  EXPECT_EQ(mesh.points.n_global(), first.mesh.points.n_global());
  double area = 0;
  for (const double v : geometry.volume) area += v;
  EXPECT_NEAR(area, 1, 1e-12);
  EXPECT_EQ(mesh.find_patch("around")->count, first.mesh.find_patch("around")->count);
}

TEST_F(LoadMesh, a_format_that_this_gmsh_was_built_without_is_refused_before_gmsh_takes_it_for_a_script) {
  const std::string text = error(write("mesh.cgns", "SystemCall \"touch intruder\";"), 2);
  EXPECT_FALSE(text.empty());
  EXPECT_FALSE(std::filesystem::exists("intruder"));
}

TEST_F(LoadMesh, tells_what_gmsh_did_not_understand) {
  const std::string text = error(write("wrong.geo", "Point(1) = {0,0,0,1};\nx = 1 2;\n"), 2);
  EXPECT_THAT(text,
              HasSubstr("gmsh could not mesh '" + (folder / "wrong.geo").string() + "' (exit code 1)."));
  EXPECT_THAT(text, HasSubstr((folder / "wrong.geo").string() + "', line 2"))
      << "the user's name of it, not that of the copy";
  EXPECT_THAT(text, HasSubstr("line 2"));
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_EQ(files_in(folder) + files_in(caches / "couplet/meshes"), 1u) << "nothing temporary is left";
}

TEST_F(LoadMesh, tells_how_to_install_gmsh_when_it_is_missing) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", folder.c_str(), 1);
  const std::string text = error(write("square.geo", "h = 0.3;\n" + square), 2);
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(text,
            "Meshes other than .msh are read with the program 'gmsh', which is not on the PATH. Install it "
            "(Debian: apt install gmsh) or give a .msh file.");
}

TEST_F(LoadMesh, tells_that_gmsh_crashed) {
  const auto gmsh = write("gmsh", "#!/bin/sh\nexit 139\n");
  std::filesystem::permissions(gmsh, std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (folder.string() + ":" + path).c_str(), 1);
  const std::string text = error(write("square.geo", "h = 0.3;\n" + square), 2);
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(text, HasSubstr("gmsh itself crashed or was killed: signal 11"));
}

TEST_F(LoadMesh, more_ranks_than_cells_are_refused) {
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {1, 1, 0}, Vec3::Zero(), Vec3::Ones());
  const int size = comm_size(MPI_COMM_WORLD);
  const std::string text = support::error_of([&] { distribute(MPI_COMM_WORLD, raw); });
  EXPECT_EQ(
      text,
      size == 1
          ? ""
          : fmt::format("The mesh has 1 cells, fewer than the {} ranks that share it. Start fewer processes.",
                        size));
}

}  // namespace couplet::load_test
