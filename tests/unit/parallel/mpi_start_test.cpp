// SPDX-License-Identifier: Apache-2.0
#include "common/parallel/mpi_start.hpp"
#include "tests/support/test.hpp"

namespace couplet::mpi_start_test {

/// What the variables are after prepare_mpi_start() in an environment of these and a HOME of its own; the test's own
/// environment comes back.
class MpiStart : public testing::Test {
 protected:
  void SetUp() override {
    for (char** entry = environ; *entry != nullptr; ++entry) {
      const std::string text = *entry;
      kept_[text.substr(0, text.find('='))] = text.substr(text.find('=') + 1);
    }
    std::filesystem::create_directories(home_ / ".openmpi");
  }
  void TearDown() override {
    ::clearenv();
    for (const auto& [name, value] : kept_) ::setenv(name.c_str(), value.c_str(), 1);
    std::filesystem::remove_all(home_);
  }
  void start(const std::map<std::string, std::string>& environment) {
    ::clearenv();
    ::setenv("HOME", home_.c_str(), 1);
    for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
    parallel::prepare_mpi_start();
  }
  static std::string value(const char* name) {
    const char* text = std::getenv(name);
    return text == nullptr ? "-" : text;
  }
  std::filesystem::path home_ =
      std::filesystem::temp_directory_path() / ("couplet-home-" + std::to_string(::getpid()));

 private:
  std::map<std::string, std::string> kept_;
};

TEST_F(MpiStart, a_program_alone_starts_no_daemon) {
  start({});
  EXPECT_EQ(value("OMPI_MCA_ess_singleton_isolated"), "1");
  EXPECT_EQ(value("OMPI_MCA_pml"), "ob1");
  EXPECT_EQ(value("OMPI_MCA_btl"), "self");
}

TEST_F(MpiStart, a_program_alone_shares_no_folder_with_others) {
  start({});
  EXPECT_EQ(value("OMPI_MCA_orte_create_session_dirs"), "0");
  start({{"OMPI_COMM_WORLD_SIZE", "4"}, {"OMPI_COMM_WORLD_LOCAL_SIZE", "4"}});
  EXPECT_EQ(value("OMPI_MCA_orte_create_session_dirs"), "-");
}

TEST_F(MpiStart, a_job_on_one_machine_uses_shared_memory) {
  start({{"OMPI_COMM_WORLD_SIZE", "4"}, {"OMPI_COMM_WORLD_LOCAL_SIZE", "4"}, {"PMIX_RANK", "1"}});
  EXPECT_EQ(value("OMPI_MCA_ess_singleton_isolated"), "-");
  EXPECT_EQ(value("OMPI_MCA_btl"), "self,vader");
  EXPECT_EQ(value("OMPI_MCA_sharedfp"), "individual");
}

TEST_F(MpiStart, a_job_over_several_machines_or_of_another_launcher_is_left_alone) {
  start({{"OMPI_COMM_WORLD_SIZE", "4"}, {"OMPI_COMM_WORLD_LOCAL_SIZE", "2"}});
  EXPECT_EQ(value("OMPI_MCA_pml"), "-");
  start({{"SLURM_PROCID", "0"}});
  EXPECT_EQ(value("OMPI_MCA_pml"), "-");
  start({{"PMIX_RANK", "0"}});
  EXPECT_EQ(value("OMPI_MCA_ess_singleton_isolated"), "-");
}

TEST_F(MpiStart, what_the_user_has_chosen_stays) {
  start({{"OMPI_MCA_btl", "self,tcp"}});
  EXPECT_EQ(value("OMPI_MCA_btl"), "self,tcp");
  EXPECT_EQ(value("OMPI_MCA_pml"), "-");
  std::ofstream(home_ / ".openmpi/mca-params.conf") << "# mine\npml = ucx\n";
  start({});
  EXPECT_EQ(value("OMPI_MCA_pml"), "-");
  EXPECT_EQ(value("OMPI_MCA_ess_singleton_isolated"), "-");
}

}  // namespace couplet::mpi_start_test
