! SPDX-License-Identifier: Apache-2.0
! Version 3 of preCICE's Fortran interface: explicit interfaces of the calls in fortran_binding.cpp. A program compiles
! this file itself, so that any compiler may be used.
module precice
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_char
  implicit none
  interface
    subroutine precicef_create(participant, configuration, rank, size)
      import
      character(kind=c_char, len=*), intent(in) :: participant, configuration
      integer(kind=c_int), intent(in) :: rank, size
    end subroutine
    subroutine precicef_initialize()
    end subroutine
    subroutine precicef_advance(dt)
      import
      real(kind=c_double), intent(in) :: dt
    end subroutine
    subroutine precicef_finalize()
    end subroutine
    subroutine precicef_get_mesh_dimensions(mesh, dimensions)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(out) :: dimensions
    end subroutine
    subroutine precicef_get_data_dimensions(mesh, datum, dimensions)
      import
      character(kind=c_char, len=*), intent(in) :: mesh, datum
      integer(kind=c_int), intent(out) :: dimensions
    end subroutine
    subroutine precicef_is_coupling_ongoing(answer)
      import
      integer(kind=c_int), intent(out) :: answer
    end subroutine
    subroutine precicef_is_time_window_complete(answer)
      import
      integer(kind=c_int), intent(out) :: answer
    end subroutine
    subroutine precicef_get_max_time_step_size(dt)
      import
      real(kind=c_double), intent(out) :: dt
    end subroutine
    subroutine precicef_requires_initial_data(answer)
      import
      integer(kind=c_int), intent(out) :: answer
    end subroutine
    subroutine precicef_requires_writing_checkpoint(answer)
      import
      integer(kind=c_int), intent(out) :: answer
    end subroutine
    subroutine precicef_requires_reading_checkpoint(answer)
      import
      integer(kind=c_int), intent(out) :: answer
    end subroutine
    subroutine precicef_requires_mesh_connectivity_for(mesh, answer)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(out) :: answer
    end subroutine
    subroutine precicef_set_vertex(mesh, position, id)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      real(kind=c_double), intent(in) :: position(*)
      integer(kind=c_int), intent(out) :: id
    end subroutine
    subroutine precicef_get_mesh_vertex_size(mesh, size)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(out) :: size
    end subroutine
    subroutine precicef_set_vertices(mesh, size, positions, ids)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(in) :: size
      real(kind=c_double), intent(in) :: positions(*)
      integer(kind=c_int), intent(out) :: ids(*)
    end subroutine
    subroutine precicef_set_edge(mesh, first, second)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(in) :: first, second
    end subroutine
    subroutine precicef_set_mesh_edges(mesh, size, ids)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(in) :: size, ids(*)
    end subroutine
    subroutine precicef_set_triangle(mesh, first, second, third)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(in) :: first, second, third
    end subroutine
    subroutine precicef_set_mesh_triangles(mesh, size, ids)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(in) :: size, ids(*)
    end subroutine
    subroutine precicef_set_quad(mesh, first, second, third, fourth)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(in) :: first, second, third, fourth
    end subroutine
    subroutine precicef_set_mesh_quads(mesh, size, ids)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(in) :: size, ids(*)
    end subroutine
    subroutine precicef_set_tetrahedron(mesh, first, second, third, fourth)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(in) :: first, second, third, fourth
    end subroutine
    subroutine precicef_set_mesh_tetrahedra(mesh, size, ids)
      import
      character(kind=c_char, len=*), intent(in) :: mesh
      integer(kind=c_int), intent(in) :: size, ids(*)
    end subroutine
    subroutine precicef_write_data(mesh, datum, size, ids, values)
      import
      character(kind=c_char, len=*), intent(in) :: mesh, datum
      integer(kind=c_int), intent(in) :: size, ids(*)
      real(kind=c_double), intent(in) :: values(*)
    end subroutine
    subroutine precicef_read_data(mesh, datum, size, ids, relative_read_time, values)
      import
      character(kind=c_char, len=*), intent(in) :: mesh, datum
      integer(kind=c_int), intent(in) :: size, ids(*)
      real(kind=c_double), intent(in) :: relative_read_time
      real(kind=c_double), intent(out) :: values(*)
    end subroutine
    subroutine precicef_requires_gradient_data_for(mesh, datum, answer)
      import
      character(kind=c_char, len=*), intent(in) :: mesh, datum
      integer(kind=c_int), intent(out) :: answer
    end subroutine
    subroutine precicef_get_version_information(text)
      import
      character(kind=c_char, len=*), intent(out) :: text
    end subroutine
    subroutine precicef_start_profiling_section(section)
      import
      character(kind=c_char, len=*), intent(in) :: section
    end subroutine
    subroutine precicef_stop_last_profiling_section()
    end subroutine
  end interface
end module
