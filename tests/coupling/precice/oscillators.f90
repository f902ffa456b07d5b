! SPDX-License-Identifier: Apache-2.0
! oscillators.cpp in Fortran, on one process. Usage: oscillators Left|Right XML STEPS
program oscillators
  use precice
  implicit none
  integer, parameter :: n = 6
  character(len=200) :: name, xml, word
  character(len=40) :: mesh, mine, other
  integer :: steps, i, ids(n), answer
  double precision :: xy(2, n), x, u(n), v(n), k(n), w0(n), w1(n), u_kept(n), v_kept(n)
  double precision :: t, t_kept, h, most, window, stiffness, force, v_new
  double precision, parameter :: spring = 15
  logical :: left
  call get_command_argument(1, name)
  call get_command_argument(2, xml)
  call get_command_argument(3, word)
  read (word, *) steps
  left = name == 'Left'
  mesh = trim(name)//'-Mesh'
  mine = 'Displacement-'//trim(name)
  other = 'Displacement-Left'
  if (left) other = 'Displacement-Right'
  call precicef_create(name, xml, 0, 1)
  do i = 1, n
    x = i - 1
    if (.not. left) x = n - i
    xy(:, i) = [x, 0d0]
    u(i) = 0.3d0*x - 0.5d0
    if (left) u(i) = 1 - 0.1d0*x
    k(i) = 30 + 2*x
    if (left) k(i) = 40 + 4*x
  end do
  v = 0
  t = 0
  call precicef_set_vertices(mesh, n, reshape(xy, [2*n]), ids)
  call precicef_requires_initial_data(answer)
  if (answer == 1) call precicef_write_data(mesh, mine, n, ids, u)
  call precicef_initialize()
  call precicef_get_max_time_step_size(window)
  open (unit=10, file=trim(name)//'-0.txt')
  do
    call precicef_is_coupling_ongoing(answer)
    if (answer == 0) exit
    call precicef_requires_writing_checkpoint(answer)
    if (answer == 1) then
      u_kept = u
      v_kept = v
      t_kept = t
    end if
    call precicef_get_max_time_step_size(most)
    h = window/steps
    if (most < 1.5d0*h) h = most
    call precicef_read_data(mesh, other, n, ids, 0d0, w0)
    call precicef_read_data(mesh, other, n, ids, h, w1)
    do i = 1, n
      stiffness = k(i) + spring
      force = spring*(w0(i) + w1(i))/2 - stiffness*(u(i) + h/4*v(i))
      v_new = (v(i) + h*force)/(1 + h*h/4*stiffness)
      u(i) = u(i) + h/2*(v(i) + v_new)
      v(i) = v_new
    end do
    call precicef_write_data(mesh, mine, n, ids, u)
    call precicef_advance(h)
    t = t + h
    call precicef_requires_reading_checkpoint(answer)
    if (answer == 1) then
      u = u_kept
      v = v_kept
      t = t_kept
    else
      call precicef_is_time_window_complete(answer)
      if (answer == 1) write (10, '(7es26.17)') t, u
    end if
  end do
  close (10)
  call precicef_finalize()
end program
