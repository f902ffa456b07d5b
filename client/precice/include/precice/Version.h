/* SPDX-License-Identifier: Apache-2.0 */
/* Version of preCICE's interface that this library of Couplet implements. */
#ifndef COUPLET_PRECICE_VERSION_H
#define COUPLET_PRECICE_VERSION_H

#define PRECICE_VERSION_MAJOR 3
#define PRECICE_VERSION_MINOR 1
#define PRECICE_VERSION_PATCH 0
#define PRECICE_VERSION "3.1.0"
#define PRECICE_VERSION_GREATER_EQUAL(major, minor, patch) \
  (PRECICE_VERSION_MAJOR > (major) ||                      \
   (PRECICE_VERSION_MAJOR == (major) &&                    \
    (PRECICE_VERSION_MINOR > (minor) ||                    \
     (PRECICE_VERSION_MINOR == (minor) && PRECICE_VERSION_PATCH >= (patch)))))

#endif
