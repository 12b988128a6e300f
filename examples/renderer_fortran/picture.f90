! Pictures of a grid that lives in this program's memory, and of a pipeline file, by the module voltet (include/voltet.f90).
!
!     gfortran -O2 voltet.f90 picture.f90 $(pkg-config --libs voltet) -o picture
!     ./picture own own.ppm                   # a grid of its own, made below
!     ./picture file scene.toml scene.ppm     # a pipeline file, with its data
!
! With a further argument, FILE.rgba, the picture is also written there as it is: 32-bit floats.
program picture
  use, intrinsic :: iso_c_binding
  use, intrinsic :: iso_fortran_env, only: error_unit
  use voltet
  implicit none

  ! A box of hexahedra around the origin, with a ball of heat: what a solver would hold.
  integer, parameter :: side = 12, across = side + 1, points_count = across**3, cells_count = side**3
  real(c_double), target :: points(3, points_count), heat(points_count)
  integer(c_int64_t), target :: corners(8, cells_count), offsets(cells_count + 1)
  integer(c_int8_t), target :: types(cells_count)

  character(kind=c_char), target :: heat_name(5) = ['h', 'e', 'a', 't', c_null_char]
  type(voltet_array), target :: arrays(1)

  character(len=*), parameter :: line = new_line('a')
  ! Two shells by s alone, and one that looks at the gradient, too.
  character(len=*), parameter :: look = &
    'unit_distance = 1.0'//line// &
    '[[widgets]]'//line// &
    'kind = "gaussian"'//line// &
    'color = [1.0, 0.4, 0.05]'//line// &
    'extinction = 40.0'//line// &
    'centre = [0.6, 1.0]'//line// &
    'sigma = [0.05, 0.2]'//line// &
    '[[widgets]]'//line// &
    'kind = "gaussian"'//line// &
    'color = [0.1, 0.3, 1.0]'//line// &
    'extinction = 6.0'//line// &
    'centre = [0.2, 1.0]'//line// &
    'sigma = [0.05, 0.5]'//line

  type(c_ptr) :: session, grid
  grid = c_null_ptr

  call need(c_null_ptr, voltet_open(session))
  if (word(1) == 'own' .and. command_argument_count() >= 2) then
    call own_scene()
    call write_picture(word(2), word(3))
  else if (word(1) == 'file' .and. command_argument_count() >= 3) then
    call need(session, voltet_load(session, voltet_text(word(2))))
    call write_picture(word(3), word(4))
  else
    write (error_unit, '(a)') 'usage: picture own PICTURE.ppm [FILE.rgba], or picture file SCENE.toml PICTURE.ppm [FILE.rgba]'
    stop 2
  end if
  call voltet_grid_release(grid)
  call need(c_null_ptr, voltet_close(session))

contains

  subroutine solve()
    ! VTK's hexahedron: around the lower face, then around the upper one.
    integer, parameter :: step(3, 8) = reshape([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, &
                                                0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], [3, 8])
    integer :: i, j, k, corner, cell
    do k = 0, side
      do j = 0, side
        do i = 0, side
          associate (p => points(:, 1 + point(i, j, k)))
            p = 2.0_c_double*[i, j, k]/side - 1.0_c_double
            heat(1 + point(i, j, k)) = 1.0_c_double - sqrt(p(1)*p(1) + p(2)*p(2) + p(3)*p(3))
          end associate
        end do
      end do
    end do
    offsets(1) = 0
    cell = 0
    do k = 0, side - 1
      do j = 0, side - 1
        do i = 0, side - 1
          cell = cell + 1
          do corner = 1, 8
            corners(corner, cell) = point(i + step(1, corner), j + step(2, corner), k + step(3, corner))
          end do
          types(cell) = 12
          offsets(cell + 1) = 8*cell
        end do
      end do
    end do
  end subroutine

  ! Numbers of points begin at 0.
  pure integer function point(i, j, k)
    integer, intent(in) :: i, j, k
    point = i + across*(j + across*k)
  end function

  ! The scene of the program's own grid.
  subroutine own_scene()
    type(voltet_grid_source) :: source
    type(voltet_camera) :: camera
    call solve()
    arrays(1)%size = c_sizeof(arrays(1))
    arrays(1)%name = c_loc(heat_name)
    arrays(1)%values = c_loc(heat)
    source%size = c_sizeof(source)
    source%point_count = points_count
    source%points = c_loc(points)
    source%array_count = 1
    source%arrays = c_loc(arrays)
    source%cell_count = cells_count
    source%types = c_loc(types)
    source%offsets = c_loc(offsets)
    source%connectivity = c_loc(corners)
    source%connectivity_count = 8*cells_count
    call need(session, voltet_grid_new(session, source, grid))
    call need(session, voltet_set_grid(session, c_null_ptr, grid))
    call need(session, voltet_set_node(session, voltet_text('transfer_function'), voltet_text(look)))
    ! Without this line a graphics device draws, where there is one.
    call need(session, voltet_set(session, voltet_text('picture.engine=cpu')))
    camera%size = c_sizeof(camera)
    camera%eye = [2.0_c_double, -4.0_c_double, 1.5_c_double]
    camera%pixels = [160, 120]
    call need(session, voltet_set_camera(session, c_null_ptr, camera))
  end subroutine

  ! Draws, and writes the picture.
  subroutine write_picture(ppm, rgba)
    character(len=*), intent(in) :: ppm, rgba
    real(c_float), allocatable, target :: floats(:, :, :)
    integer(c_int8_t), allocatable, target :: bytes(:, :, :)
    type(voltet_image) :: image
    character(len=64) :: head
    integer :: unit
    call need(session, voltet_picture_size(session, c_null_ptr, image%width, image%height))
    allocate (floats(4, image%width, image%height), bytes(3, image%width, image%height))
    image%size = c_sizeof(image)
    image%rgba = c_loc(floats)
    image%srgb = c_loc(bytes)
    call need(session, voltet_render(session, c_null_ptr, image, c_null_ptr))
    write (head, '(a, i0, 1x, i0, a)') 'P6'//line, image%width, image%height, line//'255'
    open (newunit=unit, file=ppm, access='stream', form='unformatted', status='replace')
    write (unit) trim(head)//line, bytes
    close (unit)
    if (rgba /= '') then
      open (newunit=unit, file=rgba, access='stream', form='unformatted', status='replace')
      write (unit) floats
      close (unit)
    end if
  end subroutine

  ! Ends the program where something failed, with what the library says of it.
  subroutine need(of, status)
    type(c_ptr), intent(in) :: of
    integer(c_int), intent(in) :: status
    if (status /= voltet_done) then
      write (error_unit, '(a)') 'error: '//voltet_error(of)
      stop 1
    end if
  end subroutine

  function word(number) result(text)
    integer, intent(in) :: number
    character(len=:), allocatable :: text
    character(len=1024) :: argument
    argument = ''
    if (number <= command_argument_count()) call get_command_argument(number, argument)
    text = trim(argument)
  end function

end program
