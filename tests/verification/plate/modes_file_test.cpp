// SPDX-License-Identifier: Apache-2.0
// Modes on file: written, reused, made by others, damaged; the same answer on any number of ranks.
#include "common/io/hdf5.hpp"
#include "common/modes/modal_checks.hpp"
#include "common/modes/modal_model.hpp"
#include "plate_modal/motion/surface.hpp"
#include "plate_modal/structure.hpp"
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::modes_file_test {
using namespace mesh;
using namespace modes;
using namespace parallel;

using namespace test;
namespace fs = std::filesystem;

class PlateModesFile : public ::testing::Test {
 protected:
  PlateModesFile() {
    int id = ::getpid();
    MPI_Bcast(&id, 1, MPI_INT, 0, MPI_COMM_WORLD);
    folder_ = fs::temp_directory_path() / fmt::format("couplet-plate-{}", id);
    if (comm_rank(MPI_COMM_WORLD) == 0) fs::create_directories(folder_);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  ~PlateModesFile() override {
    MPI_Barrier(MPI_COMM_WORLD);
    std::error_code ignored;
    if (comm_rank(MPI_COMM_WORLD) == 0) fs::remove_all(folder_, ignored);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  PlateContext context(MPI_Comm comm = MPI_COMM_WORLD) const {
    return {comm, "plate", folder_, folder_, std::numeric_limits<double>::quiet_NaN()};
  }
  static Parameters parameters() {
    Parameters p;
    p.material = {1000, 1e9, 0.3};
    p.thickness = 0.05;
    p.number = 6;
    p.output.fields = false;
    for (const char* patch : {"xmax", "ymin", "ymax"}) p.boundaries[patch];
    p.boundaries["xmin"].support = Support::clamped;
    return p;
  }
  /// Displacement after ten steps under a load, on rank 0.
  static std::vector<double> run(Structure& structure) {
    const coupling::Interface interface = structure.initialise();
    coupling::Exchange in;
    for (const Vec3& x : interface.face_centres)
      for (const double f : {0.01, 0.02 * x.y(), 0.1 + x.x()}) in["pressure-force"].push_back(f);
    for (int i = 0; i < 10; ++i) {
      structure.begin_step({0.01 * i, 0.01, coupling::Scheme::standalone, i});
      structure.solve(in);
      structure.accept_step();
    }
    return structure.displacement();
  }
  fs::path folder_;
};

TEST_F(PlateModesFile, ranks_agree) {
  const RawMesh raw = square(7);
  PlateContext alone_context{MPI_COMM_SELF, "plate", {}, {}, std::numeric_limits<double>::quiet_NaN()};
  Structure together(parameters(), context(), &raw), alone(parameters(), alone_context, &raw);
  const std::vector<double> a = run(together), b = run(alone);
  if (comm_rank(MPI_COMM_WORLD) != 0) return;
  double apart = 0, largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    apart = std::max(apart, std::abs(a[i] - b[i])), largest = std::max(largest, std::abs(b[i]));
  EXPECT_GT(largest, 0);
  EXPECT_LT(apart, 1e-12 * largest);
  RecordProperty("apart", fmt::format("{:.2e}", apart / largest));
}

TEST_F(PlateModesFile, modes_are_reused_while_mesh_and_data_are_the_same) {
  const RawMesh raw = square(7), finer = square(8);
  Structure first(parameters(), context(), &raw);
  const std::string key = key_of_modes(folder_ / "modes.h5");
  ASSERT_FALSE(key.empty());
  MPI_Barrier(MPI_COMM_WORLD);
  const auto time = fs::last_write_time(folder_ / "modes.h5");
  Structure second(parameters(), context(), &raw);
  EXPECT_EQ(fs::last_write_time(folder_ / "modes.h5"), time);
  const std::vector<double> a = run(first), b = run(second);
  EXPECT_EQ(a, b);
  for (int change = 0; change < 5; ++change) {
    Parameters other = parameters();
    if (change == 1) other.thickness *= 1 + 1e-15;
    if (change == 2) other.number = 7;
    if (change == 3) other.boundaries["xmin"].support = Support::simply_supported;
    if (change == 4) other.placement.origin = Vec3(0, 0, 1);
    MPI_Barrier(MPI_COMM_WORLD);
    Structure changed(other, context(), change == 0 ? &finer : &raw);
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_NE(key_of_modes(folder_ / "modes.h5"), key) << change;
  }
}

TEST_F(PlateModesFile, a_cut_pair_is_said_again_in_the_next_run) {
  if (comm_size(MPI_COMM_WORLD) > 1) return;
  const RawMesh raw = square(6, BoxCells::quadrilaterals);
  Parameters p = parameters();
  for (auto& [patch, edge] : p.boundaries) edge.support = Support::clamped;
  for (const int number : {2, 3}) {
    p.number = number;
    for (int run = 0; run < 2; ++run) {
      const Built built = build_model(p, context(), &raw);
      EXPECT_EQ(built.note.find("have the same frequency") != std::string::npos, number == 2) << run;
      EXPECT_EQ(built.reused, number == 3 && run == 1);
    }
  }
}

TEST_F(PlateModesFile, a_structure_runs_on_the_modes_of_a_file_as_on_those_of_its_mesh) {
  const RawMesh raw = square(7);
  Structure from_mesh(parameters(), context(), &raw);
  MPI_Barrier(MPI_COMM_WORLD);
  Parameters p;
  p.modes_file = "modes.h5";
  p.output.fields = false;
  PlateContext where = context();
  where.output_folder.clear();
  Structure from_file(p, where);
  EXPECT_EQ(run(from_mesh), run(from_file));
}

TEST_F(PlateModesFile, what_is_wrong_with_a_file_is_said) {
  if (comm_size(MPI_COMM_WORLD) > 1) return;
  const RawMesh raw = square(3);
  Structure structure(parameters(), context(), &raw);
  const fs::path good = folder_ / "modes.h5", file = folder_ / "other.h5";
  const auto message = [&] {
    try {
      read_modes(file);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message().find("does not exist"), std::string::npos);
  std::ofstream(file) << "no HDF5";
  EXPECT_NE(message().find("Cannot use the modes file"), std::string::npos);
  const ModalModel model = read_modes(good);
  const auto damaged = [&](auto&& change) {
    ModalModel copy = model;
    change(copy);
    write_modes(file, copy, "");
    return message();
  };
  EXPECT_EQ(damaged([](ModalModel&) {}), "");
  // What no structure has.
  const auto scaled = [](std::vector<double>& values, double factor) {
    for (double& value : values) value *= factor;
  };
  const auto says = [&](const char* what, auto&& change) {
    const std::string text = damaged(change);
    EXPECT_NE(text.find(what), std::string::npos) << what << " / " << text;
  };
  says("mass of the structure is -1", [](ModalModel& m) { m.mass = -1; });
  says("mass of the structure is 0", [](ModalModel& m) { m.mass = 0; });
  says("the density of face 2 is -3", [](ModalModel& m) { m.face_density[1] = -3; });
  says("mode 1 is 0 everywhere", [&](ModalModel& m) { scaled(m.vertex_shape, 0), scaled(m.face_shape, 0); });
  says("mode 1 at the faces", [&](ModalModel& m) { scaled(m.vertex_shape, 1e3); });
  says("mode 1 at the faces", [&](ModalModel& m) { scaled(m.face_shape, -1); });
  says("along z add up to", [&](ModalModel& m) { scaled(m.participation, 10); });
  says("shapes and participation are from different modes",
       [&](ModalModel& m) { scaled(m.participation, 0.1); });
  says("mode 1 is not mass-normalized",
       [&](ModalModel& m) { scaled(m.vertex_shape, 1e3), scaled(m.face_shape, 1e3); });
  says("mode 1 is not mass-normalized", [&](ModalModel& m) {
    m.face_density.clear(), scaled(m.vertex_shape, 1e3), scaled(m.face_shape, 1e3);
  });
  says("no mode is mass-normalized", [&](ModalModel& m) {
    for (auto* part : {&m.vertex_shape, &m.face_shape, &m.participation}) scaled(*part, 1e-3);
  });
  // Rows component by component, and no shapes at the faces or densities that would tell.
  const auto by_component = [](ModalModel& m) {
    const std::vector<double> right = m.vertex_shape;
    const std::size_t n = m.n_modes(), vertices = m.vertices.size();
    for (std::size_t v = 0; v < vertices; ++v)
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < n; ++i)
          m.vertex_shape[(c * vertices + v) * n + i] = right[(3 * v + c) * n + i];
    average_faces(m);
  };
  says("to list all x components first", by_component);
  says("to list all x components first", [&](ModalModel& m) { m.face_density.clear(), by_component(m); });
  says("mode 1 at the faces", [&](ModalModel& m) { m.face_density.clear(), scaled(m.face_shape, 2); });
  // One shape twice: its load would count twice.
  says("modes 1 and 2 are not orthogonal", [](ModalModel& m) {
    const std::size_t n = m.n_modes();
    for (auto* part : {&m.vertex_shape, &m.face_shape, &m.participation})
      for (std::size_t i = 0; i < part->size(); i += n) {
        const double both = ((*part)[i] + (*part)[i + 1]) / std::sqrt(2.);
        (*part)[i] = both;
      }
  });
  says("face 2 refers to vertex", [](ModalModel& m) { m.faces.index[4] = m.faces.index[3]; });
  says("is inside out", [](ModalModel& m) { std::swap(m.faces.index[3], m.faces.index[4]); });
  says("mode 1 has a frequency of 0 Hz, but its shape is not a rigid-body motion",
       [](ModalModel& m) { m.frequency[0] = 0; });
  EXPECT_EQ(damaged([](ModalModel& m) { m.face_density.clear(); }), "");
  EXPECT_NE(damaged([](ModalModel& m) { m.frequency[3] = -1; }).find("frequency of mode 4"),
            std::string::npos);
  EXPECT_NE(damaged([](ModalModel& m) { m.frequency[3] = 0.5 * m.frequency[2]; }).find("lower frequency"),
            std::string::npos);
  EXPECT_NE(damaged([](ModalModel& m) { m.vertex_shape[5] = NAN; }).find("not finite"), std::string::npos);
  says("refers to vertex 999", [](ModalModel& m) { m.faces.index[4] = 999; });
  says("refers to vertex 998", [](ModalModel& m) { m.faces.index.back() = 998; });
  EXPECT_NE(damaged([](ModalModel& m) { m.participation.resize(12); }).find("participation"),
            std::string::npos);
  EXPECT_NE(damaged([](ModalModel& m) { m.vertex_shape.resize(m.vertex_shape.size() - 6); }).find("rows"),
            std::string::npos);
}

// A square of which one corner is lifted by 1: its mean is 1/4, it turns by 1/4 about both axes, and the saddle
// that is left has 1/4 at each corner.
TEST(SurfaceMotion, of_a_corner_is_a_rigid_motion_and_a_saddle_of_the_same_size) {
  ModalModel model;
  model.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  model.faces.offset = {0, 4}, model.faces.index = {0, 1, 2, 3};
  model.frequency = {1};
  model.vertex_shape.assign(12, 0), model.vertex_shape.back() = 1;
  model.participation.assign(3, 0);
  average_faces(model);
  const RigidMotion motion = rigid_motion(model, 0);
  EXPECT_LT((motion.translation - Vec3(0, 0, 0.25)).norm(), 1e-14);
  EXPECT_LT((motion.rotation - Vec3(0.25, 0.25, 0)).norm(), 1e-14);
  EXPECT_NEAR(motion.misfit, 0.5, 1e-14);
  const double lift = 3;
  EXPECT_EQ(Surface(model).motion({&lift, 1}).back(), lift);
}

TEST(ModalMass, is_the_mass_times_the_square_of_a_shape_that_is_everywhere_the_same) {
  ModalModel model = block();  // 1 kg that moves by 1 as a whole
  EXPECT_EQ(scale_problem_of(model), "");
  for (double& value : model.vertex_shape) value *= 200;
  average_faces(model);
  const std::string text = scale_problem_of(model);
  EXPECT_NE(text.find("the surface alone has a modal mass of 4e+04 kg,"), std::string::npos) << text;
}

TEST_F(PlateModesFile, a_surface_turned_inside_out_is_refused_unless_it_is_a_cavity) {
  if (comm_size(MPI_COMM_WORLD) > 1) return;
  const RawMesh raw = square(6);
  const auto text_of = [&](const Parameters& p) {
    try {
      build_model(p, context());
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  // The rims of held edges are not part of the surface: none, one, two opposite ones, all are missing.
  for (const int held : {0, 1, 2, 4}) {
    Parameters p = parameters();
    int i = 0;
    for (const char* patch : {"xmin", "xmax", "ymin", "ymax"})
      p.boundaries[patch].support = i++ < held ? Support::clamped : Support::free;
    const Built built = build_model(p, context(), &raw);
    const std::optional<double> volume = volume_behind(built.model);
    ASSERT_TRUE(volume);
    EXPECT_NEAR(*volume, 0.05, held == 0 || held == 1 ? 1e-12 : 0.04) << held;
    Parameters of_file;
    of_file.modes_file = "other.h5";
    write_modes(folder_ / "other.h5", built.model, "");
    EXPECT_EQ(text_of(of_file), "") << held;
    ModalModel turned = built.model;
    for (Index f = 0; f < turned.faces.size(); ++f)
      std::reverse(turned.faces.index.begin() + turned.faces.offset[f],
                   turned.faces.index.begin() + turned.faces.offset[f + 1]);
    write_modes(folder_ / "other.h5", turned, "");
    EXPECT_NE(text_of(of_file).find("inside out"), std::string::npos) << held << text_of(of_file);
    of_file.cavity = true;
    EXPECT_EQ(text_of(of_file), "") << held;
    write_modes(folder_ / "other.h5", built.model, "");
    EXPECT_NE(text_of(of_file).find("those of a cavity wall"), std::string::npos) << held << text_of(of_file);
  }
  // A sheet has no other side.
  Parameters p = parameters();
  p.wetted = Wetted::lower;
  EXPECT_FALSE(volume_behind(build_model(p, context(), &raw).model));
}

/// Turns the faces of which it is true.
ModalModel turned(ModalModel model, auto&& which) {
  for (Index f = 0; f < model.faces.size(); ++f)
    if (which(f))
      std::reverse(model.faces.index.begin() + model.faces.offset[f],
                   model.faces.index.begin() + model.faces.offset[f + 1]);
  return model;
}

/// Only vertices and faces: what the sides are judged by.
ModalModel surface_of(const ModalModel& model, auto&& own_vertices) {
  ModalModel apart;
  apart.vertices = model.vertices;
  for (Index f = 0; f < model.faces.size(); ++f) {
    std::vector<Index> corners(model.faces[f].begin(), model.faces[f].end());
    if (own_vertices(f))
      for (Index& v : corners) {
        apart.vertices.push_back(model.vertices[v]);
        v = Index(apart.vertices.size()) - 1;
      }
    apart.faces.push_row(corners);
  }
  return apart;
}

/// Both, the second moved by `shift` and `scale` times as large.
ModalModel with(ModalModel a, const ModalModel& b, double scale, const Vec3& shift) {
  const auto first = Index(a.vertices.size());
  for (const Vec3& x : b.vertices) a.vertices.push_back(scale * x + shift);
  for (Index f = 0; f < b.faces.size(); ++f) {
    std::vector<Index> corners;
    for (const Index v : b.faces[f]) corners.push_back(first + v);
    a.faces.push_row(corners);
  }
  return a;
}

TEST_F(PlateModesFile, turned_faces_are_found_wherever_parts_share_no_vertices) {
  if (comm_size(MPI_COMM_WORLD) > 1) return;
  const RawMesh raw = square(5);
  const auto all = [](Index) { return true; };
  const ModalModel body =
      surface_of(build_model(parameters(), PlateContext{}, &raw).model, [](Index) { return false; });
  const auto half = [&](Index f) { return face_centres(body)[std::size_t(f)].x() > 0.5; };
  // A seam of vertices that are there twice, and vertices of its own for each face.
  EXPECT_EQ(facing_problem_of(surface_of(body, half)), "");
  EXPECT_NE(facing_problem_of(surface_of(turned(body, half), half)).find("share an edge"), std::string::npos);
  const auto second = [](Index f) { return f % 2 == 1; };
  EXPECT_EQ(facing_problem_of(surface_of(body, all)), "");
  EXPECT_NE(facing_problem_of(surface_of(turned(body, second), all)).find("share an edge"),
            std::string::npos);
  // Two bodies of which one is turned, be it as large or smaller; a hollow in a body looks into it.
  for (const double scale : {1., 0.7}) {
    EXPECT_EQ(facing_problem_of(with(body, body, scale, Vec3(0, 0, 1))), "");
    const std::string text = facing_problem_of(with(body, turned(body, all), scale, Vec3(0, 0, 1)));
    EXPECT_NE(text.find("the faces of part 2 of 2"), std::string::npos) << text;
  }
  const Vec3 middle = 0.5 * Vec3(0.5, 0.5, 0);
  EXPECT_EQ(facing_problem_of(with(body, turned(body, all), 0.5, middle)), "");
  EXPECT_NE(facing_problem_of(with(body, body, 0.5, middle)).find("part 2 of 2"), std::string::npos);
}

TEST_F(PlateModesFile, of_two_sheets_each_looks_away_from_the_other) {
  if (comm_size(MPI_COMM_WORLD) > 1) return;
  const RawMesh raw = square(5, BoxCells::quadrilaterals);
  Parameters p = parameters();
  for (auto& [patch, edge] : p.boundaries) edge.support = Support::clamped;
  const ModalModel plate = build_model(p, PlateContext{}, &raw).model;
  EXPECT_EQ(facing_problem_of(plate), "");
  for (const int sheet : {1, 2}) {
    const ModalModel wrong = turned(plate, [&](Index f) { return (f < 25) == (sheet == 1); });
    const std::string text = facing_problem_of(wrong);
    EXPECT_NE(text.find(fmt::format("part {} of 2", sheet)), std::string::npos) << text;
    EXPECT_NE(facing_problem_of(wrong, Facing::inward), "");
  }
  // A second plate above it, nearer than it is thick.
  EXPECT_EQ(facing_problem_of(with(plate, plate, 1, Vec3(0, 0, 0.06))), "");
  // A sheet alone may look anywhere.
  p.wetted = Wetted::lower;
  const ModalModel alone = build_model(p, PlateContext{}, &raw).model;
  EXPECT_EQ(facing_problem_of(alone) + facing_problem_of(alone, Facing::inward), "");
}

/// A sheet of n squares of edge 1 in a row at z, each with vertices of its neighbours, from x on; looking up.
ModalModel strip(int n, double x, double z) {
  ModalModel sheet;
  for (int i = 0; i <= n; ++i)
    for (const int y : {0, 1}) sheet.vertices.push_back(Vec3(x + i, y, z));
  for (Index i = 0; i < n; ++i)
    sheet.faces.push_row(std::vector<Index>{2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  return sheet;
}

// A long sheet between one that lies above its first half and one that lies below the other. The rest of it sees nothing.
TEST_F(PlateModesFile, a_sheet_whose_neighbours_contradict_each_other_is_named) {
  const auto between = [](int seen) {
    const ModalModel above = strip(seen, 0, 1), below = strip(seen, seen, -1);
    const auto down = [](const ModalModel& m) { return turned(m, [](Index) { return true; }); };
    return facing_problem_of(
        with(with(strip(20, 0, 0), above, 1, Vec3::Zero()), down(below), 1, Vec3::Zero()));
  };
  EXPECT_NE(between(8).find("cannot determine on which side of the faces of part 1 of 3"), std::string::npos)
      << between(8);
  EXPECT_NE(between(8).find("50 % of them face away from other faces and 50 % toward them"),
            std::string::npos)
      << between(8);
  EXPECT_EQ(between(3), "");  // most of it sees nothing: it may look anywhere
}

TEST_F(PlateModesFile, kept_modes_that_were_edited_are_found_again) {
  if (comm_size(MPI_COMM_WORLD) > 1) return;
  const RawMesh raw = square(4);
  const Built first = build_model(parameters(), context(), &raw);
  const std::string key = key_of_modes(folder_ / "modes.h5");
  for (int change = 0; change < 4; ++change) {
    ModalModel edited = first.model;
    if (change == 1) edited.frequency[5] *= 1.01;
    if (change == 2) *std::ranges::max_element(edited.vertex_shape) *= 1.0001;
    if (change == 3) edited.mass = -1;  // would be refused in a file of another program
    write_modes(folder_ / "modes.h5", edited, key);
    const Built again = build_model(parameters(), context(), &raw);
    EXPECT_EQ(again.reused, change == 0) << change;
    EXPECT_EQ(again.model.frequency, first.model.frequency) << change;
    EXPECT_EQ(key_of_modes(folder_ / "modes.h5"), key) << change;
  }
}

}  // namespace couplet::plate::modes_file_test
