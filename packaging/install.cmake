# SPDX-License-Identifier: Apache-2.0
# What is installed beside the programs and the client (each OPTIONAL: any build can be installed), and the .deb of it (cpack).
include(GNUInstallDirs)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON) # what was built is installed, no more
set(share ${CMAKE_INSTALL_DATADIR}/couplet)

install(PROGRAMS scripts/couplet scripts/couplet-exec DESTINATION ${CMAKE_INSTALL_BINDIR})
file(WRITE ${PROJECT_BINARY_DIR}/VERSION "${PROJECT_VERSION}\n")
install(FILES ${PROJECT_BINARY_DIR}/VERSION DESTINATION ${share}/python/couplet)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md DESTINATION ${share}) # pages of the site
install(DIRECTORY configs docs DESTINATION ${share} PATTERN "out" EXCLUDE PATTERN "out-*" EXCLUDE PATTERN "*.cache.msh" EXCLUDE
        PATTERN "*.log" EXCLUDE PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY client/examples DESTINATION ${share}/client) # cases and pages refer to them
install(FILES common/mesh/gmsh/deck.py common/mesh/gmsh/deck_mesh.py DESTINATION ${share}/common/mesh/gmsh) # for couplet import
install(FILES README.md CHANGELOG.md CITATION.cff LICENSE packaging/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
# Man pages, completion, the reference of keys and the schemas come from what the command and the programs declare.
find_program(COUPLET_PYTHON python3 HINTS /usr/bin NO_DEFAULT_PATH)
find_program(COUPLET_PYTHON python3 REQUIRED)

# An installation without them cannot link programs of others.
install(CODE "
  foreach(file client/libcouplet_client.a precice/lib/libprecice.so)
    if(NOT EXISTS \"${PROJECT_BINARY_DIR}/\${file}\")
      message(WARNING \"\${file} was not built, so own C++ programs or those of preCICE cannot be linked: \"
                      \"scripts/build release couplet_client precice_couplet\")
    endif()
  endforeach()")

# Where Debian's Python looks: below /usr, /usr/local, and ~/.local or the prefix of an environment. The same files each time.
execute_process(COMMAND ${COUPLET_PYTHON} -c "import sys; print('python%d.%d' % sys.version_info[:2])" OUTPUT_VARIABLE python
                OUTPUT_STRIP_TRAILING_WHITESPACE)
install(CODE "
  set(places python3/dist-packages)
  if(NOT CMAKE_INSTALL_PREFIX STREQUAL /usr)
    list(APPEND places ${python}/dist-packages ${python}/site-packages)
  endif()
  foreach(place \${places})
    set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/lib/\${place}\")
    file(MAKE_DIRECTORY \"\${folder}\")
    file(CREATE_LINK ../../../share/couplet/python/couplet \"\${folder}/couplet\" SYMBOLIC)
  endforeach()")
install(CODE "
  execute_process(COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_SOURCE_DIR}/client/python ${COUPLET_PYTHON} -B -m couplet.command.pages
                          \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\" --bin ${PROJECT_BINARY_DIR}/bin --version ${PROJECT_VERSION}
                  RESULT_VARIABLE failed)
  if(failed)
    message(WARNING \"man pages, completion, keys and schemas were not installed (python3-yaml and python3-numpy are needed)\")
  endif()")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME couplet)
set(CPACK_PACKAGE_VENDOR "Couplet")
set(CPACK_PACKAGE_CONTACT "Couplet maintainers <couplet@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "couples fluid, structure and mesh programs into one MPI job")
set(CPACK_PACKAGE_DESCRIPTION "Solvers of fluids, solids, plates and heat storage, a mesh mover and a coupler, each a program of its own,
described by one YAML file and run by one command.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/prerm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "openmpi-bin, python3, python3-yaml, python3-numpy, python3-h5py")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gmsh, python3-matplotlib, python3-scipy, python3-mpi4py")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "paraview, mkdocs-material")
include(CPack)
