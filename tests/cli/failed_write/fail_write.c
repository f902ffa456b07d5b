// SPDX-License-Identifier: Apache-2.0
// To be preloaded: the K-th write to a file below out/, except logs, fails once with EIO (environment: COUPLET_FAIL), as on a network disk or at a
// quota.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

static int count;

static int fails(int file) {
  char link[64], path[600];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t n = readlink(link, path, sizeof path - 1);
  if (n < 0 || file < 3) return 0;
  path[n] = 0;
  const char* below = strstr(path, "/out/");
  const char* wanted = getenv("COUPLET_FAIL");
  if (!below || !wanted || strstr(below, ".log") || ++count != atoi(wanted)) return 0;
  dprintf(2, "this write fails: %s\n", below + 1);
  errno = EIO;
  return 1;
}

ssize_t write(int file, const void* data, size_t n) {
  ssize_t (*const real)(int, const void*, size_t) = dlsym(RTLD_NEXT, "write");
  return fails(file) ? -1 : real(file, data, n);
}

ssize_t writev(int file, const struct iovec* data, int n) {
  ssize_t (*const real)(int, const struct iovec*, int) = dlsym(RTLD_NEXT, "writev");
  return fails(file) ? -1 : real(file, data, n);
}

ssize_t pwrite64(int file, const void* data, size_t n, off_t at) {
  ssize_t (*const real)(int, const void*, size_t, off_t) = dlsym(RTLD_NEXT, "pwrite64");
  return fails(file) ? -1 : real(file, data, n, at);
}

ssize_t pwrite(int file, const void* data, size_t n, off_t at) { return pwrite64(file, data, n, at); }
