// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/sandbox.hpp"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "common/base/error.hpp"

namespace couplet::mesh {
namespace {

namespace fs = std::filesystem;

// Rights of the first version of Landlock (Linux 5.13), which all later versions support.
constexpr std::uint64_t reading =
    LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t everything = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;
constexpr std::uint64_t of_a_file =
    LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE;

#if defined(__x86_64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t architecture = 0;  // no barrier
#endif

int create_rules(const landlock_ruleset_attr* attributes, std::size_t size, std::uint32_t flags) {
  return static_cast<int>(syscall(SYS_landlock_create_ruleset, attributes, size, flags));
}

bool allow(int rules, const fs::path& path, std::uint64_t rights) {
  const int fd = open(path.c_str(), O_PATH | O_CLOEXEC);
  if (fd < 0) return true;  // does not exist
  std::error_code ignored;
  landlock_path_beneath_attr below{};
  below.allowed_access = fs::is_directory(path, ignored) ? rights : rights & of_a_file;
  below.parent_fd = fd;
  const bool done = syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &below, 0) == 0;
  close(fd);
  return done;
}

// System calls with external effects that Landlock's first version does not restrict. A new process would be
// harmless by itself, but not its actions.
constexpr long refused_calls[] = {SYS_fchmod,
                                  SYS_fchmodat,
                                  SYS_fchown,
                                  SYS_fchownat,
                                  SYS_utimensat,
                                  SYS_truncate,
                                  SYS_setxattr,
                                  SYS_lsetxattr,
                                  SYS_fsetxattr,
                                  SYS_removexattr,
                                  SYS_lremovexattr,
                                  SYS_fremovexattr,
                                  SYS_socket,
                                  SYS_socketpair,
                                  SYS_kill,
                                  SYS_tkill,
                                  SYS_tgkill,
                                  SYS_rt_sigqueueinfo,
                                  SYS_rt_tgsigqueueinfo,
                                  SYS_ptrace,
                                  SYS_process_vm_readv,
                                  SYS_process_vm_writev,
                                  SYS_pidfd_open,
                                  SYS_pidfd_send_signal,
                                  SYS_pidfd_getfd,
                                  SYS_io_uring_setup,
                                  SYS_bpf,
                                  SYS_perf_event_open,
                                  SYS_userfaultfd,
                                  SYS_keyctl,
                                  SYS_add_key,
                                  SYS_request_key,
                                  SYS_shmget,
                                  SYS_shmctl,
                                  SYS_semget,
                                  SYS_semctl,
                                  SYS_msgget,
                                  SYS_msgctl,
                                  SYS_mq_open,
                                  SYS_mq_unlink,
                                  SYS_setpriority,
                                  SYS_sched_setaffinity,
                                  SYS_unshare,
                                  SYS_setns,
                                  SYS_mount};
#if defined(__x86_64__)
constexpr long older_calls[] = {SYS_fork,   SYS_vfork, SYS_chmod,  SYS_chown,
                                SYS_lchown, SYS_utime, SYS_utimes, SYS_futimesat};
#else
constexpr std::array<long, 0> older_calls{};
#endif

constexpr std::uint32_t refusal(int error) { return SECCOMP_RET_ERRNO | std::uint32_t(error); }

std::vector<sock_filter> filter() {
  constexpr std::uint32_t number = offsetof(seccomp_data, nr), arch = offsetof(seccomp_data, arch),
                          first_argument = offsetof(seccomp_data, args);
  const auto load = [](std::uint32_t at) { return sock_filter(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, at)); };
  const auto end = [](std::uint32_t what) { return sock_filter(BPF_STMT(BPF_RET | BPF_K, what)); };
  const auto equals = [](std::uint32_t value, std::uint8_t skip_otherwise) {
    return sock_filter(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, skip_otherwise));
  };
  std::vector<sock_filter> f{load(arch), equals(architecture, 1),
                             sock_filter(BPF_JUMP(BPF_JMP | BPF_JA, 1, 0, 0)), end(SECCOMP_RET_KILL_PROCESS),
                             load(number)};
  // Newer calls than these lists, and calls of another range on some kernels, fail as on an older kernel.
  f.push_back(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, SYS_landlock_restrict_self + 1, 0, 1));
  f.push_back(end(refusal(ENOSYS)));
  const auto refuse = [&](const auto& calls) {
    for (const long call : calls) {
      f.push_back(equals(std::uint32_t(call), 1));
      f.push_back(end(refusal(EPERM)));
    }
  };
  refuse(refused_calls);
  refuse(older_calls);
  f.push_back(equals(SYS_clone3, 1));  // its flags are not visible here; the C library falls back to clone()
  f.push_back(end(refusal(ENOSYS)));
  f.push_back(equals(SYS_prlimit64, 4));  // only its own limits
  f.push_back(load(first_argument));
  f.push_back(equals(0, 1));
  f.push_back(end(SECCOMP_RET_ALLOW));
  f.push_back(end(refusal(EPERM)));
  f.push_back(equals(SYS_clone, 3));
  f.push_back(load(first_argument));
  f.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0));
  f.push_back(end(refusal(EPERM)));
  f.push_back(end(SECCOMP_RET_ALLOW));
  return f;
}

}  // namespace

bool Barrier::is_possible() {
  return architecture != 0 && create_rules(nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) >= 1;
}

Barrier::Barrier(const std::vector<fs::path>& readable, const fs::path& writable) : filter_(filter()) {
  landlock_ruleset_attr handled{};
  handled.handled_access_fs = everything;
  rules_ = create_rules(&handled, sizeof handled, 0);
  bool done = rules_ >= 0 &&
              allow(rules_, writable, everything & ~std::uint64_t(LANDLOCK_ACCESS_FS_EXECUTE)) &&
              allow(rules_, "/dev/null", LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE);
  for (const fs::path& path : readable) done = done && allow(rules_, path, reading);
  if (!done) throw Error("Cannot confine a program by Landlock: {}.", std::strerror(errno));
}

Barrier::~Barrier() {
  if (rules_ >= 0) close(rules_);
}

bool Barrier::put_up() const {
  const sock_fprog program{static_cast<unsigned short>(filter_.size()),
                           const_cast<sock_filter*>(filter_.data())};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && syscall(SYS_landlock_restrict_self, rules_, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

}  // namespace couplet::mesh
