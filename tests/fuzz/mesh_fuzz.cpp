// SPDX-License-Identifier: Apache-2.0
// Broken meshes through the readers and the set-up of a distributed mesh, in one process: see README.md.
#include "common/mesh/gmsh/gmsh.hpp"
#include "common/mesh/load.hpp"
#include "tests/fuzz/mutate.hpp"

namespace couplet::fuzz::mesh_fuzz {
using namespace mesh;

namespace fs = std::filesystem;

const std::vector<std::string> numbers{"0",
                                       "-1",
                                       "1",
                                       "2",
                                       "3",
                                       "15",
                                       "99",
                                       "-3",
                                       "1e308",
                                       "nan",
                                       "inf",
                                       "2147483648",
                                       "18446744073709551615",
                                       "9999999999999999999999",
                                       "1e-320",
                                       "0.5",
                                       "x",
                                       "\"\"",
                                       "$Nodes",
                                       "$EndNodes",
                                       "$Elements",
                                       "$EndElements",
                                       "$PhysicalNames",
                                       "$Periodic"};

/// Some words replaced, the rest as it is.
std::string mutate_words(const std::string& text, Dice& dice) {
  std::string result = text;
  for (std::size_t n = 1 + dice.below(5); n > 0; --n) {
    const std::size_t at = result.find_first_of(" \n", dice.below(result.size()));
    if (at == std::string::npos) continue;
    const std::size_t end = std::min(result.find_first_of(" \n", at + 1), result.size());
    result.replace(at + 1, end - at - 1, dice.of(numbers));
  }
  return result;
}

TEST(Meshes, broken_ones_are_read_or_refused) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("couplet-fuzz-mesh-{}", ::getpid());
  fs::create_directories(folder);
  std::vector<std::string> texts, geometries;
  for (const char* dim : {"plane", "solid"}) {
    for (const char* kind : {"22_ascii", "22_binary", "41_ascii", "41_binary"})
      texts.push_back(read_file(fs::path(COUPLET_SOURCE_DIR) / "tests/unit/mesh/data" /
                                fmt::format("{}_{}.msh", dim, kind)));
    geometries.push_back(
        read_file(fs::path(COUPLET_SOURCE_DIR) / "tests/unit/mesh/data" / fmt::format("{}.geo", dim)));
  }
  Dice dice(seed());
  std::size_t read = 0, refused = 0;
  double slowest = 0;
  const auto attempt = [&](const char* name, const std::string& text, const auto& use) {
    const fs::path file = folder / name;
    write_file(file, text);
    const auto start = std::chrono::steady_clock::now();
    try {
      use(file);
      ++read;
    } catch (const Error&) {
      ++refused;
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    slowest = std::max(slowest, seconds);
    EXPECT_LT(seconds, 5) << file;
  };
  const auto load = [](const fs::path& file) {
    const RawMesh raw = read_msh(file);
    if (!raw.cell_type.empty()) distribute(MPI_COMM_SELF, raw);
  };
  const auto scan = [](const fs::path& file) { read_geo(file); };
  // What a parser that calls itself, or one that looks for the end of a bracket again and again, does not bear.
  for (const char c : {'[', '{', '(', '"', '/', ' '}) {
    attempt("last.geo", "DefineConstant [" + std::string(200000, c), scan);
    attempt("last.geo", std::string(200000, c), scan);
  }
  std::string long_geo;
  for (int i = 0; i < 40000; ++i) long_geo += "DefineConstant [ n = {1, Name \"a\"} ]; Printf(\"x\");\n";
  attempt("last.geo", long_geo, scan);
  for (std::size_t i = 0; i < count(); ++i) {
    if (dice.one_in(10)) {
      attempt("last.geo", mutate_bytes(dice.of(geometries), dice), scan);
      continue;
    }
    std::string text = dice.of(texts);
    text = dice.one_in(2) ? mutate_words(text, dice) : mutate_bytes(text, dice);
    if (dice.one_in(5)) text = mutate_lines(text, numbers, dice);
    attempt("last.msh", text, load);
  }
  EXPECT_GT(refused, count() / 4);
  EXPECT_LT(peak_memory(), 1000);
  RecordProperty("tried", int(read + refused));
  RecordProperty("refused", int(refused));
  RecordProperty("slowest", fmt::format("{:.3f}", slowest));
  RecordProperty("megabytes", fmt::format("{:.0f}", peak_memory()));
  fs::remove_all(folder);
}

}  // namespace couplet::fuzz::mesh_fuzz
