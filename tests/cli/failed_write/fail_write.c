// SPDX-License-Identifier: Apache-2.0
// To be preloaded: a fault of the machine at the K-th operation on a file below out/, except logs. Writes, flushes, cuts, closes of written files and renames count.
// COUPLET_FAIL="PROGRAM K error" fails this operation once with EIO, as on a network disk or at a quota; "PROGRAM K kill" writes half of the data and kills the
// program. COUPLET_WRITES names a file that gets a line "PROGRAM OPERATION FILE" for each operation.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

static int count;

/// 0 to go on, 1 to fail, 2 to be killed after half of the data.
static int fault_at(const char* path, const char* operation) {
  const char *below = strstr(path, "/out/"), *file = getenv("COUPLET_WRITES"), *fault = getenv("COUPLET_FAIL");
  if (!below || strstr(below, ".log")) return 0;
  if (file) {
    char line[700];
    const int n = snprintf(line, sizeof line, "%s %s %s\n", program_invocation_short_name, operation, below + 1);
    const int out = open(file, O_WRONLY | O_APPEND | O_CREAT, 0666);
    ((ssize_t(*)(int, const void*, size_t))dlsym(RTLD_NEXT, "write"))(out, line, (size_t)n);
    ((int (*)(int))dlsym(RTLD_NEXT, "close"))(out);
  }
  char program[64], how[16];
  int at;
  if (!fault || sscanf(fault, "%63s %d %15s", program, &at, how) != 3 || strcmp(program, program_invocation_short_name) || ++count != at) return 0;
  dprintf(2, "this %s %s: %s\n", operation, *how == 'k' ? "kills" : "fails", below + 1);
  errno = EIO;
  return *how == 'k' ? 2 : 1;
}

static int fault_of(int file, const char* operation) {
  char link[64], path[600];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t n = file < 3 ? -1 : readlink(link, path, sizeof path - 1);
  if (n < 0 || (fcntl(file, F_GETFL) & O_ACCMODE) == O_RDONLY) return 0;
  path[n] = 0;
  return fault_at(path, operation);
}

#define FAULTY(operation, half, whole)                       \
  switch (fault_of(file, operation)) {                       \
    case 1: return -1;                                       \
    case 2: (void)!(half), raise(SIGKILL);                   \
  }                                                          \
  return whole;

ssize_t write(int file, const void* data, size_t n) {
  ssize_t (*const real)(int, const void*, size_t) = dlsym(RTLD_NEXT, "write");
  FAULTY("write", real(file, data, n / 2), real(file, data, n))
}

ssize_t writev(int file, const struct iovec* data, int n) {
  ssize_t (*const real)(int, const struct iovec*, int) = dlsym(RTLD_NEXT, "writev");
  FAULTY("write", real(file, data, n / 2), real(file, data, n))
}

ssize_t pwrite64(int file, const void* data, size_t n, off_t at) {
  ssize_t (*const real)(int, const void*, size_t, off_t) = dlsym(RTLD_NEXT, "pwrite64");
  FAULTY("write", real(file, data, n / 2, at), real(file, data, n, at))
}

ssize_t pwrite(int file, const void* data, size_t n, off_t at) { return pwrite64(file, data, n, at); }

int fsync(int file) {
  int (*const real)(int) = dlsym(RTLD_NEXT, "fsync");
  FAULTY("fsync", 0, real(file))
}

int ftruncate64(int file, off_t n) {
  int (*const real)(int, off_t) = dlsym(RTLD_NEXT, "ftruncate64");
  FAULTY("ftruncate", 0, real(file, n))
}

int ftruncate(int file, off_t n) { return ftruncate64(file, n); }

int close(int file) {
  int (*const real)(int) = dlsym(RTLD_NEXT, "close");
  const int fault = fault_of(file, "close"), error = errno, done = real(file);
  if (fault == 2) raise(SIGKILL);
  errno = fault ? error : errno;
  return fault ? -1 : done;
}

int rename(const char* from, const char* to) {
  char path[600];
  snprintf(path, sizeof path, "/%s", to);
  const int fault = fault_at(path, "rename");
  if (fault == 2) raise(SIGKILL);
  return fault ? -1 : ((int (*)(const char*, const char*))dlsym(RTLD_NEXT, "rename"))(from, to);
}
