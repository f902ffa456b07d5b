// SPDX-License-Identifier: Apache-2.0
// Crafted files of modes and checkpoints: refused with an Error, or read as something sound. See README.md.
#include "common/io/checkpoint.hpp"
#include "common/io/checkpoint_format.hpp"
#include "common/io/checkpoint_set.hpp"
#include "common/modes/modal_model.hpp"
#include "coupler/acceleration/quasi_newton.hpp"
#include "coupler/parameters/parameters.hpp"
#include "tests/fuzz/craft_hdf5.hpp"

namespace couplet::fuzz::hdf5_fuzz {
using namespace io;
using namespace modes;

namespace fs = std::filesystem;
using Type = CraftedValue::Type;
using Link = CraftedValue::Link;

CraftedValue text_value(const std::string& path, const std::string& text) {
  return {.path = path, .is_attribute = true, .type = Type::text, .text = text};
}
CraftedValue number(const std::string& path, double value) {
  return {.path = path, .is_attribute = true, .values = {value}};
}
CraftedValue table(const std::string& path, std::vector<std::uint64_t> size, std::vector<double> values) {
  return {.path = path, .size = std::move(size), .values = std::move(values)};
}
CraftedValue integers(const std::string& path, std::vector<std::uint64_t> size,
                      std::vector<std::int64_t> values) {
  return {.path = path, .type = Type::i64, .size = std::move(size), .integers = std::move(values)};
}

/// A hinged square sheet of 4 x 4 faces, three modes.
ModalModel sheet() {
  constexpr int n = 4, modes = 3;
  ModalModel m;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) m.vertices.emplace_back(double(i) / n, double(j) / n, 0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i;
      m.faces.push_row(std::vector<Index>{a, a + 1, a + n + 2, a + n + 1});
    }
  m.frequency = {10, 25, 26};
  m.mass = 10;
  m.face_density.assign(n * n, 10);
  const int waves[modes][2] = {{1, 1}, {2, 1}, {1, 2}};
  for (const Vec3& x : m.vertices)
    for (int c = 0; c < 3; ++c)
      for (const auto& [p, q] : waves)
        m.vertex_shape.push_back(c < 2 ? 0
                                       : 2 / std::sqrt(10.) * std::sin(p * std::numbers::pi * x[0]) *
                                             std::sin(q * std::numbers::pi * x[1]));
  m.face_shape.assign(3 * n * n * modes, 0);
  average_faces(m);
  m.participation.assign(3 * modes, 0);
  for (int f = 0; f < n * n; ++f)
    for (int k = 0; k < modes; ++k)
      m.participation[2 * modes + k] += 10. / (n * n) * m.face_shape[(3 * f + 2) * modes + k];
  return m;
}

CraftedFile modes_file(const ModalModel& m) {
  const std::uint64_t n = m.n_modes(), vertices = m.vertices.size(), faces = std::uint64_t(m.faces.size());
  std::vector<double> places;
  for (const Vec3& x : m.vertices) places.insert(places.end(), x.begin(), x.end());
  return {
      text_value("format", "couplet modes"),
      number("version", 1),
      number("mass", m.mass),
      text_value("key", "0123-4567"),
      table("frequency", {n}, m.frequency),
      table("surface/vertices", {vertices, 3}, places),
      integers("surface/face-offset", {faces + 1}, {m.faces.offset.begin(), m.faces.offset.end()}),
      integers("surface/face-vertex", {m.faces.index.size()}, {m.faces.index.begin(), m.faces.index.end()}),
      table("surface/face-density", {faces}, m.face_density),
      table("shape/vertices", {3 * vertices, n}, m.vertex_shape),
      table("shape/faces", {3 * faces, n}, m.face_shape),
      table("participation", {3, n}, m.participation)};
}

/// What the reader has let through holds together.
void expect_sound(const ModalModel& m) {
  const std::size_t n = m.n_modes(), vertices = m.vertices.size(), faces = std::size_t(m.faces.size());
  ASSERT_EQ(m.vertex_shape.size(), 3 * vertices * n);
  ASSERT_EQ(m.face_shape.size(), 3 * faces * n);
  ASSERT_EQ(m.participation.size(), 3 * n);
  ASSERT_TRUE(m.face_density.empty() || m.face_density.size() == faces);
  ASSERT_TRUE(std::isfinite(m.mass));
  for (const Index v : m.faces.index) ASSERT_TRUE(v >= 0 && std::size_t(v) < vertices);
}

void add_array(CraftedFile& file, const std::string& name, const std::vector<double>& values) {
  file.push_back(table("arrays/" + name, {values.size()}, values));
  file.push_back(integers("layout/" + name, {1}, {std::int64_t(values.size())}));
}

void add_field(CraftedFile& file, const std::string& name, std::size_t rows,
               const std::vector<double>& values) {
  const std::size_t width = rows == 0 ? 0 : values.size() / rows;
  file.push_back(width > 1 ? table("fields/" + name, {rows, width}, values)
                           : table("fields/" + name, {rows}, values));
  file.push_back(integers("checks/" + name, {1, 2}, {std::int64_t(rows), std::int64_t(width)}));
}

/// Of a coupler with two columns, and of a participant that saves one array.
CraftedFile checkpoint_file(const CheckpointStamp& stamp) {
  CraftedFile file{text_value("format", "couplet checkpoint"), number("version", checkpoint_version),
                   number("ranks", 1), text_value("set", stamp.text())};
  add_array(file, "u", std::vector<double>(50, 1.5));
  add_field(file, "iqn.images", 3, {1, 4, 2, 5, 3, 6});
  add_field(file, "iqn.dependents", 0, {});
  add_field(file, "iqn.q", 3, {1, 0, 0, 1, 0, 0});
  add_array(file, "iqn.r", {4, 1, 0, 0.5, 1});
  add_array(file, "iqn.step", {3, 2, 3, 2});
  add_array(file, "dt", {0.1});
  return file;
}

/// Lengths made to fit what the arrays have become.
void recompute(CraftedFile& file) {
  for (CraftedValue& layout : file) {
    if (layout.path.starts_with("checks/")) {
      const std::string name = "fields/" + layout.path.substr(7);
      for (CraftedValue& field : file)
        if (field.path == name && field.size.size() == 2 && field.size[0] * field.size[1] < 100000) {
          field.values.resize(field.size[0] * field.size[1]);
          layout.integers = {std::int64_t(field.size[0]), std::int64_t(field.size[1])};
        }
    }
    if (!layout.path.starts_with("layout/")) continue;
    const std::string name = "arrays/" + layout.path.substr(7);
    for (CraftedValue& array : file)
      if (array.path == name && array.size.size() == 1 && array.size[0] < 100000) {
        array.values.resize(array.size[0]);
        layout.integers = {std::int64_t(array.size[0])};
      }
  }
}

/// All that a restart does with it.
void read_checkpoint(const fs::path& file) {
  CheckpointReader reader(MPI_COMM_SELF, file);
  std::vector<double> u(50);
  reader.read("u", u);
  ASSERT_LT(reader.read("u").size(), 51u);
  double dt = 0;
  io::Archive archive(reader);
  archive.common("dt", dt);
  coupler::QuasiNewton newton(coupler::AccelerationParameters{}, MPI_COMM_SELF);
  newton.visit(archive, coupler::IterateOrder::as_they_are(MPI_COMM_SELF,
                                                           {std::vector<double>(3), std::vector<double>(0)}));
}

std::set<std::string> tree(const fs::path& folder) {
  std::set<std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) all.insert(entry.path().string());
  return all;
}

struct Sums {
  std::size_t tried = 0, refused = 0;
  double slowest = 0;
};

/// `make` writes case i and `read` reads it; whatever it throws but an Error is a failure.
Sums try_all(const fs::path& folder, const std::function<void()>& make, const std::function<void()>& read) {
  Sums sums;
  for (; sums.tried < count(); ++sums.tried) {
    make();
    const std::set<std::string> before = tree(folder);
    const auto start = std::chrono::steady_clock::now();
    try {
      read();
    } catch (const Error& error) {
      ++sums.refused;
      const std::string text = error.what();
      EXPECT_NE(text.find("'"), std::string::npos) << "no file is named: " << text;
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    sums.slowest = std::max(sums.slowest, seconds.count());
    EXPECT_EQ(tree(folder), before) << "case " << sums.tried << " made or removed files";
    if (::testing::Test::HasFailure()) break;
  }
  EXPECT_LT(sums.slowest, double(longest()));
  EXPECT_LT(peak_memory(), 1000);
  EXPECT_GT(sums.refused, sums.tried / 3);
  ::testing::Test::RecordProperty("tried", int(sums.tried));
  ::testing::Test::RecordProperty("refused", int(sums.refused));
  ::testing::Test::RecordProperty("slowest", fmt::format("{:.2f}", sums.slowest));
  ::testing::Test::RecordProperty("megabytes", fmt::format("{:.0f}", peak_memory()));
  return sums;
}

class CraftedFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "case");
    fs::create_directories(folder_ / "outside");
    // What links and outer storage point to is there, so that only the reader keeps it away.
    write(folder_ / "outside/other.h5", modes_file(sheet()));
    write_file(folder_ / "outside/values.bin", std::string(1 << 20, '\1'));
  }
  void TearDown() override {
    if (!HasFailure()) fs::remove_all(folder_);
  }
  fs::path folder_ = fs::temp_directory_path() / fmt::format("couplet-fuzz-hdf5-{}", ::getpid());
  Dice dice_{seed()};
};

TEST_F(CraftedFiles, modes_are_refused_or_sound) {
  const fs::path file = folder_ / "case/modes.h5";
  const CraftedFile right = modes_file(sheet());
  write(file, right);
  ASSERT_NO_THROW(expect_sound(read_modes(file)));
  const auto make = [&] {
    write(file, dice_.one_in(4) ? right : mutate(right, dice_));
    if (dice_.one_in(3)) damage_bytes(file, dice_);
  };
  try_all(folder_, make, [&] {
    key_of_modes(file);
    expect_sound(read_modes(file));
  });
}

TEST_F(CraftedFiles, checkpoints_with_digests_that_fit_are_refused_or_sound) {
  const CheckpointStamp stamp{"r1", 7, 0.7};
  const fs::path set = folder_ / "case/checkpoints/step-00000007", file = set / "solid.h5";
  const CraftedFile right = checkpoint_file(stamp);
  const auto finish = [&](const std::function<void()>& make) {
    fs::remove_all(set);
    begin_checkpoint_set(set.parent_path(), stamp);
    make();
    finish_checkpoint_set(set, stamp);  // with the digests of what is there now
  };
  finish([&] { write(file, right); });
  ASSERT_NO_THROW(read_checkpoint(file));
  EXPECT_EQ(problem_of_checkpoint(file), "");
  const auto make = [&] {
    finish([&] {
      CraftedFile crafted = dice_.one_in(4) ? right : mutate(right, dice_);
      if (!dice_.one_in(3)) recompute(crafted);
      write(file, crafted);
      if (dice_.one_in(3)) damage_bytes(file, dice_);
    });
  };
  try_all(folder_, make, [&] {
    problem_of_checkpoint(file);
    read_checkpoint(file);
  });
}

/// Each fault by itself, with the message that names file, object, what was found and what was expected.
TEST_F(CraftedFiles, each_fault_has_its_sentence) {
  const fs::path file = folder_ / "case/modes.h5";
  const auto message = [&](const std::string& path, const std::function<void(CraftedValue&)>& change) {
    CraftedFile content = modes_file(sheet());
    for (CraftedValue& v : content)
      if (v.path == path) change(v);
    write(file, content);
    try {
      read_modes(file);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto expect = [&](const std::string& path, const char* words,
                          const std::function<void(CraftedValue&)>& change) {
    const std::string text = message(path, change);
    EXPECT_NE(text.find(words), std::string::npos) << words << " / " << text;
    EXPECT_NE(text.find(file.string()), std::string::npos) << text;
  };
  EXPECT_EQ(message("", [](CraftedValue&) {}), "");
  EXPECT_EQ(message("frequency", [](CraftedValue& v) { v.store = CraftedValue::Store::deflated; }), "");
  EXPECT_EQ(message("mass", [](CraftedValue& v) { v.size = {1}; }), "");
  expect("mass", "the attribute 'mass' of '/' contains 6 values (float64); expected one number",
         [](CraftedValue& v) { v.size = {6}; });
  expect("mass", "a compound type", [](CraftedValue& v) { v.type = Type::compound; });
  expect("format", "text of variable length", [](CraftedValue& v) { v.type = Type::text_of_any_length; });
  expect("format", "of at most 256 bytes", [](CraftedValue& v) { v.text.assign(4000, 'x'); });
  expect("frequency", "is a soft link", [](CraftedValue& v) { v.link = Link::soft_loop; });
  expect("frequency", "is a link to another file", [](CraftedValue& v) { v.link = Link::external; });
  expect("frequency", "expected a table", [](CraftedValue& v) { v.link = Link::cycle; });
  expect("frequency", "are stored in another file",
         [](CraftedValue& v) { v.store = CraftedValue::Store::other_file; });
  expect("frequency", "composed of tables in other files",
         [](CraftedValue& v) { v.store = CraftedValue::Store::virtual_table; });
  expect("frequency", "uses filter 32000",
         [](CraftedValue& v) { v.store = CraftedValue::Store::unknown_filter; });
  expect("frequency", "declares 8589934592 bytes of values",
         [](CraftedValue& v) { v.size = {1u << 30}, v.store = CraftedValue::Store::unwritten; });
  expect("shape/vertices", "has 75 rows of 4 values; expected 75 of 3", [](CraftedValue& v) {
    v.size = {75, 4};
  });
  expect("surface/face-vertex", "dimensions of integers", [](CraftedValue& v) { v.type = Type::f64; });
}

}  // namespace couplet::fuzz::hdf5_fuzz
