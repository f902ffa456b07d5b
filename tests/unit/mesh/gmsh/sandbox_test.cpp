// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/sandbox.hpp"

#include <csignal>

#include "tests/unit/mesh/support.hpp"

namespace couplet::sandbox_test {
using namespace mesh;

namespace fs = std::filesystem;

/// A script in the place of the program, first on the PATH.
class Sandbox : public ::testing::Test {
 protected:
  Sandbox() : path_(std::getenv("PATH")) { setenv("PATH", (own_.path.string() + ":" + path_).c_str(), 1); }
  ~Sandbox() override { setenv("PATH", path_.c_str(), 1); }

  ProgramEnd run(const std::string& script, std::vector<fs::path> readable = {}) {
    fs::permissions(own_.write("program", "#!/bin/bash\n" + script), fs::perms::owner_all);
    return run_in_sandbox({"program", "word"}, folder_.path(), folder_.path() / "out.log",
                          std::move(readable));
  }
  std::string output() const {
    std::ifstream in(folder_.path() / "out.log");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  test::TemporaryFolder own_;
  OwnFolder folder_;
  std::string path_;
};

TEST_F(Sandbox, the_end_of_a_program_is_reported) {
  EXPECT_EQ(run("exit 7").code, 7);
  EXPECT_EQ(run("echo \"$1\"; exit 0").code, 0);
  EXPECT_EQ(output(), "word\n");
  EXPECT_EQ(run("ulimit -f 0; echo text > file").signal, SIGXFSZ);
  EXPECT_THROW(run_in_sandbox({"no-such-program"}, folder_.path(), folder_.path() / "out.log"), Error);
  fs::permissions(own_.write("program", "#!/no/such/shell\n"), fs::perms::owner_all);
  EXPECT_NE(
      support::error_of([&] { run_in_sandbox({"program"}, folder_.path(), folder_.path() / "out.log"); }),
      "");
}

TEST_F(Sandbox, its_folder_is_its_home_and_goes_with_it) {
  setenv("COUPLET_SECRET", "1", 1);
  run("echo \"$HOME $TMPDIR $PWD $COUPLET_SECRET\"");
  unsetenv("COUPLET_SECRET");
  const std::string own = folder_.path().string();
  EXPECT_EQ(output(), own + " " + own + " " + own + " \n");
  fs::path gone;
  {
    const OwnFolder other;
    gone = other.path();
    EXPECT_EQ(fs::status(gone).permissions(), fs::perms::owner_all);
  }
  EXPECT_FALSE(fs::exists(gone));
}

/// Checks that only the names in `done` succeed of all that a program tries.
TEST_F(Sandbox, a_program_writes_only_in_its_folder_and_reaches_nothing_else) {
  if (!Barrier::is_possible()) GTEST_SKIP() << "this kernel has no Landlock";
  const std::string own = own_.path.string(), readable = own_.write("readable", "text").string(),
                    secret = own_.write("secret", "text").string();
  std::ofstream(folder_.path() / "kept") << "text";
  // Bash does all of this by itself, without starting a program.
  run("exec 2> /dev/null\n"
      "try() { if eval \"$2\"; then echo \"$1\"; fi; }\n"
      "try inside ': > inside'\n"
      "try read '[[ $(< " +
          readable + ") ]] || read -r x < " + readable +
          "'\n"
          "try outside ': > " +
          own +
          "/outside'\n"
          "try append ': >> " +
          readable +
          "'\n"
          "try secret 'read -r x < " +
          secret +
          "'\n"
          "try tmp ': > /tmp/couplet-outside'\n"
          "try network ': > /dev/tcp/127.0.0.1/9'\n"
          "try signal 'kill -0 $PPID'\n"
          "try process '/bin/true'\n",
      {readable});
  EXPECT_EQ(output(), "inside\nread\n");
  EXPECT_TRUE(fs::exists(folder_.path() / "inside"));
  EXPECT_FALSE(fs::exists(own_.path / "outside"));
}

TEST_F(Sandbox, a_trusted_program_has_the_users_rights) {
  fs::permissions(own_.write("program", "#!/bin/sh\ntouch \"$1\"\n"), fs::perms::owner_all);
  EXPECT_EQ(run_trusted({"program", (own_.path / "outside").string()}, folder_.path() / "out.log").code, 0);
  EXPECT_TRUE(fs::exists(own_.path / "outside"));
}

}  // namespace couplet::sandbox_test
