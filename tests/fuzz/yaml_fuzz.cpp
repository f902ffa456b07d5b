// SPDX-License-Identifier: Apache-2.0
// Broken cases through what --check does, in one process: see README.md.
#include <regex>

#include "common/app/case/case_file.hpp"
#include "tests/fuzz/mutate.hpp"
#include "tests/fuzz/program.hpp"

namespace couplet::fuzz::yaml_fuzz {

namespace fs = std::filesystem;

const std::vector<std::string>& values() {
  static const std::vector<std::string> list = [] {
    const std::string brackets(19000, '('), long_word(5000, 'x');
    return std::vector<std::string>{"",
                                    "~",
                                    "-1",
                                    "0",
                                    "1e308",
                                    "1e-320",
                                    "nan",
                                    "inf",
                                    "-.inf",
                                    "99999999999999999999",
                                    "0x10",
                                    "true",
                                    "3.5",
                                    "-3",
                                    "[]",
                                    "{}",
                                    "[1, 2]",
                                    "[1, 2, 3, 4]",
                                    "[[1]]",
                                    "{a: 1}",
                                    "[x, y]",
                                    "-10 MPa",
                                    "5 furlongs",
                                    "1 m^",
                                    "1 " + brackets + "m",
                                    "1 m/s/s/s",
                                    "x",
                                    "sin(x",
                                    "6*y*(1-Y)",
                                    "1/0",
                                    "sqrt(-1)",
                                    brackets + "x",
                                    std::string("x").append(3000, '+') + "1",
                                    "table(t, 0, 0, 1, 1)",
                                    "table(t, 0",
                                    "'table(t, \"no.csv\")'",
                                    "'table(t, \"/dev/zero\")'",
                                    "'table(x, \"square.msh\", 1e300)'",
                                    "{of: t, at: [0, 1], values: [0, 1]}",
                                    "{of: q, at: [0], values: []}",
                                    "{of: t, file: /dev/null, column: -7}",
                                    "{of: t, file: square.msh, column: 99999999999}",
                                    "../../../etc/passwd",
                                    "-x.msh",
                                    "''",
                                    "\"\\x01\"",
                                    "\"a\\nb\"",
                                    long_word,
                                    "&a [*a]",
                                    "&b 1",
                                    "*b",
                                    "!!python/object x",
                                    "!<x> y",
                                    "| x",
                                    "> x",
                                    "%",
                                    "@",
                                    "`",
                                    "? x",
                                    "- x",
                                    "null",
                                    "0.1.2",
                                    "1,5",
                                    "2 to 3",
                                    "10 %",
                                    "300 degC",
                                    "-400 degC",
                                    "1e400 m",
                                    "[1 m, 2]",
                                    "[1 bar, [2]]",
                                    "study",
                                    "interface",
                                    "fixed-displacement",
                                    "traction",
                                    "inlet",
                                    "outlet",
                                    "aitken",
                                    "implicit"};
  }();
  return list;
}

/// Whatever a message is about, it says where: a place in the file, or an option of the command line.
bool says_where(const std::string& message) {
  static const std::regex place(R"((^|\n)?(case\.yaml|[^ ]*/case\.yaml):[0-9]+:[0-9]+: )");
  const std::string start = message.substr(0, 300);
  return std::regex_search(start, place) || start.starts_with("--");
}

class Corpus {
 public:
  explicit Corpus(const std::string& program) {
    const fs::path root = COUPLET_SOURCE_DIR;
    for (const char* folder : {"configs", "tests/cli/wrong"})
      for (const auto& entry : fs::recursive_directory_iterator(root / folder))
        if (entry.path().extension() == ".yaml" && entry.path().string().find("/out/") == std::string::npos) {
          const std::string text = read_file(entry.path());
          const bool is_mine = text.find("program: " + program) != std::string::npos ||
                               (program == "coupler" && text.find("\ncoupling:") != std::string::npos);
          if (is_mine && text.size() < 20000) files_.emplace(entry.path().string(), text);
        }
    for (const auto& [name, text] : files_) texts.push_back(text);
  }
  std::vector<std::string> texts;

 private:
  std::map<std::string, std::string> files_;  // sorted, so that every machine has them in one order
};

/// Inputs that grow with their size where nobody looks.
std::vector<std::string> large_inputs(const std::string& text) {
  std::string bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n";
  for (char c = 'b'; c < 'n'; ++c) {
    bomb += fmt::format("{0}: &{0} [", c);
    for (int i = 0; i < 9; ++i) bomb += fmt::format("{}*{}", i ? ", " : "", char(c - 1));
    bomb += "]\n";
  }
  std::string keys = text + "\n", names = "participants:\n";
  for (int i = 0; i < 20000; ++i) {
    keys += fmt::format("unknown-{}: {}\n", i, i);
    names += fmt::format("  p{}: {{program: nobody}}\n", i);
  }
  std::string inside = text;
  if (const std::size_t at = inside.find("    program:"); at != std::string::npos) {
    std::string more;
    for (int i = 0; i < 20000; ++i) more += fmt::format("    unknown-{}: {}\n", i, i);
    inside.insert(at, more);
  }
  const std::string deep(19000, '['), braces = [] {
    std::string s;
    for (int i = 0; i < 19000; ++i) s += "{a: ";
    return s;
  }();
  return {bomb, text + bomb, keys,  names, inside, deep, braces, std::string(19000, '&'),
          "",   "\n",        "\0x", "x",   "[]",   "- 1"};
}

TEST(Yaml, broken_cases_are_refused_with_a_place_in_time_and_memory) {
  const ProgramUnderTest program;
  const std::string name = program.name();
  const fs::path folder = fs::temp_directory_path() / fmt::format("couplet-fuzz-{}-{}", name, ::getpid());
  fs::create_directories(folder);
  fs::copy_file(fs::path(COUPLET_SOURCE_DIR) / "tests/cli/wrong/square.msh", folder / "square.msh",
                fs::copy_options::overwrite_existing);
  const Corpus corpus(name);
  ASSERT_FALSE(corpus.texts.empty());
  app::CommandLine command_line;
  command_line.case_file = folder / "case.yaml";
  Dice dice(seed());
  std::size_t refused = 0, tried = 0, unplaced = 0;
  double slowest = 0;
  const auto attempt = [&](const std::string& text) {
    write_file(command_line.case_file, text);
    const auto start = std::chrono::steady_clock::now();
    const app::Program kind = program.fresh();
    app::CaseFile file = app::read_case(command_line, kind);
    if (file.errors.empty() && !kind.is_coupler)
      file.errors = app::problems_of_files(*file.document, file.participant, folder);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    slowest = std::max(slowest, seconds);
    EXPECT_LT(seconds, longest()) << command_line.case_file;
    ++tried;
    refused += !file.errors.empty();
    for (const std::string& message : file.errors)
      if (!says_where(message) && ++unplaced <= 5) ADD_FAILURE() << "no place in: " << message.substr(0, 300);
  };
  for (const std::string& text : large_inputs(corpus.texts.front())) attempt(text);
  for (std::size_t i = 0; i < count() && !testing::Test::HasFatalFailure(); ++i) {
    std::string text = dice.of(corpus.texts);
    if (!dice.one_in(4)) text = mutate_lines(text, values(), dice);
    if (dice.one_in(3)) text = mutate_bytes(text, dice);
    if (dice.one_in(20)) text += "\n" + dice.of(corpus.texts);
    attempt(text);
  }
  EXPECT_EQ(unplaced, 0u);
  EXPECT_GT(refused, tried / 3) << "most of what is tried is meant to be wrong";
  EXPECT_LT(peak_memory(), 1000);
  RecordProperty("tried", int(tried));
  RecordProperty("refused", int(refused));
  RecordProperty("unplaced", int(unplaced));
  RecordProperty("slowest", fmt::format("{:.3f}", slowest));
  RecordProperty("megabytes", fmt::format("{:.0f}", peak_memory()));
  fs::remove_all(folder);
}

}  // namespace couplet::fuzz::yaml_fuzz
