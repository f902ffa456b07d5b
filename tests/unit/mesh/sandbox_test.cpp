// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/sandbox.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "support.hpp"

namespace couplet::sandbox_test {
using namespace mesh;
namespace {

namespace fs = std::filesystem;

/// A script in the place of the program, first on the PATH.
class Sandbox : public ::testing::Test {
 protected:
  Sandbox() : path_(std::getenv("PATH")) { setenv("PATH", (own_.path.string() + ":" + path_).c_str(), 1); }
  ~Sandbox() override { setenv("PATH", path_.c_str(), 1); }

  ProgramEnd run(const std::string& script) {
    fs::permissions(own_.write("program", "#!/bin/sh\n" + script), fs::perms::owner_all);
    return run_in_sandbox({"program", "word"}, folder_.path(), folder_.path() / "out.log");
  }
  std::string output() const {
    std::ifstream in(folder_.path() / "out.log");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static bool has_bubblewrap() {
    return std::system("bwrap --unshare-user --unshare-net --ro-bind / / true > /dev/null 2>&1") == 0;
  }

  test::TemporaryFolder own_;
  OwnFolder folder_;
  std::string path_;
};

TEST_F(Sandbox, the_end_of_a_program_is_reported) {
  EXPECT_EQ(run("exit 7").code, 7);
  EXPECT_EQ(run("echo \"$1\"; exit 0").code, 0);
  EXPECT_EQ(output(), "word\n");
  const ProgramEnd killed = run("kill -9 $$");
  EXPECT_TRUE(killed.signal == SIGKILL || killed.code == 128 + SIGKILL);  // bubblewrap gives it as a code
  EXPECT_THROW(run_in_sandbox({"no-such-program"}, folder_.path(), folder_.path() / "out.log"), Error);
  fs::permissions(own_.write("program", "#!/no/such/shell\n"), fs::perms::owner_all);
  EXPECT_TRUE(has_bubblewrap() || !test::error_of([&] {
                                     run_in_sandbox({"program"}, folder_.path(), folder_.path() / "out.log");
                                   }).empty());
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

TEST_F(Sandbox, with_bubblewrap_only_its_folder_can_be_written_to_and_there_is_no_network) {
  if (!has_bubblewrap()) GTEST_SKIP() << "bubblewrap cannot start here";
  run("touch inside; touch " + (own_.path / "outside").string() + "; grep -c : /proc/net/dev");
  EXPECT_TRUE(fs::exists(folder_.path() / "inside"));
  EXPECT_FALSE(fs::exists(own_.path / "outside"));
  EXPECT_NE(output().find("\n1\n"), std::string::npos) << "the loopback alone: " << output();
}

TEST_F(Sandbox, a_trusted_program_has_the_users_rights) {
  fs::permissions(own_.write("program", "#!/bin/sh\ntouch \"$1\"\n"), fs::perms::owner_all);
  EXPECT_EQ(run_trusted({"program", (own_.path / "outside").string()}, folder_.path() / "out.log").code, 0);
  EXPECT_TRUE(fs::exists(own_.path / "outside"));
}

}  // namespace
}  // namespace couplet::sandbox_test
