! fortran-cells: the format of examples/plugin_c/reader.c, which says how it is written, read in Fortran.
!
!     gfortran -O2 -shared -fPIC -I../../include -o reader.so ../../include/voltet_plugin.f90 ../../include/voltet_reader.f90 \
!         reader.f90 ../../include/voltet_plugin_fortran.c
module cells_reader
  use, intrinsic :: iso_c_binding
  use voltet_plugin
  use voltet_reader
  implicit none

contains

  subroutine voltet_filters() bind(c)
    call voltet_describe_plugin("simple cells in Fortran", "1.0.0")
    call voltet_add_reader("fortran-cells", "Reads a text of points, cells and arrays, with time steps.", &
      c_funloc(inspect), c_funloc(read_file), extensions=["cells"], magic="cells 1")
    call voltet_add_number("scale", "the factor on positions", default=1.0_c_double, min=1e-9_c_double, max=1e9_c_double)
  end subroutine

  ! Says how large the grid is and which arrays there are, from the file's first lines.
  function inspect(reading, host) result(code) bind(c)
    type(voltet_reading), intent(in) :: reading
    type(voltet_host), intent(in) :: host
    integer(c_int32_t) :: code
    type(voltet_contents) :: contents
    character(200) :: message
    integer :: unit, status
    call open_file(reading, unit, contents, status, message)
    if (status == 0) close (unit)
    code = failed(host, status, message)
    if (status == 0) code = voltet_describe_contents(reading, contents)
  end function

  ! Opens the file and reads its header; `status` is not 0 where that fails.
  subroutine open_file(reading, unit, contents, status, message)
    type(voltet_reading), intent(in) :: reading
    integer, intent(out) :: unit, status
    type(voltet_contents), intent(out) :: contents
    character(*), intent(inout) :: message
    character(64) :: word, name, place
    integer :: steps, arrays, components, i
    open (newunit=unit, file=voltet_path(reading), status="old", action="read", iostat=status, iomsg=message)
    if (status /= 0) return
    read (unit, *, iostat=status, iomsg=message) word, i
    if (status == 0) read (unit, *, iostat=status, iomsg=message) word, contents%point_count
    if (status == 0) read (unit, *, iostat=status, iomsg=message) word, contents%cell_count, contents%connectivity_count
    if (status == 0) read (unit, *, iostat=status, iomsg=message) word, steps
    if (status == 0 .and. (steps < 0 .or. steps > 1024)) then
      message = "there are no or more than 1024 steps"
      status = 1
    end if
    if (status == 0) then
      ! The line once more, now that the number of times is known.
      backspace (unit)
      allocate (contents%times(steps))
      read (unit, *, iostat=status, iomsg=message) word, steps, contents%times
    end if
    if (status == 0) read (unit, *, iostat=status, iomsg=message) word, arrays
    do i = 1, merge(arrays, 0, status == 0)
      read (unit, *, iostat=status, iomsg=message) name, place, components
      if (status /= 0) exit
      call voltet_add_array(contents, trim(name), components, on_cells=place == "cells")
      if (i == 1) contents%scalar = trim(name)
    end do
    contents%format = "simple cells, text"
    if (status /= 0) close (unit)
  end subroutine

  ! Reads what is asked for; the rest of the text is passed over.
  function read_file(reading, host) result(code) bind(c)
    type(voltet_reading), intent(in) :: reading
    type(voltet_host), intent(in) :: host
    integer(c_int32_t) :: code
    type(voltet_contents) :: contents
    character(200) :: message
    integer :: unit, status
    call open_file(reading, unit, contents, status, message)
    if (status == 0) then
      if (voltet_is_as_described(reading, contents)) then
        call read_grid(reading, unit, contents, status, message)
      else
        message = "the file has changed since it was looked at"
        status = 1
      end if
      close (unit)
    end if
    code = failed(host, status, message)
  end function

  subroutine read_grid(reading, unit, contents, status, message)
    type(voltet_reading), intent(in) :: reading
    integer, intent(in) :: unit
    type(voltet_contents), intent(in) :: contents
    integer, intent(out) :: status
    character(*), intent(inout) :: message
    real(c_double), pointer :: points(:, :), values(:, :)
    real(c_double), allocatable :: passed(:)
    integer(c_int64_t) :: step
    integer :: place
    points => voltet_read_points(reading)
    if (associated(points)) then
      read (unit, *, iostat=status, iomsg=message) points
      points = points*voltet_number(reading, 1)
    else
      allocate (passed(3*contents%point_count))
      read (unit, *, iostat=status, iomsg=message) passed
    end if
    if (status == 0) call read_cells(reading, unit, contents, status, message)
    do step = 0, reading%step
      do place = 1, voltet_array_count(contents)
        if (status /= 0) return
        values => voltet_read_array(reading, contents, place)
        if (step == reading%step .and. associated(values)) then
          read (unit, *, iostat=status, iomsg=message) values
        else
          if (allocated(passed)) deallocate (passed)
          allocate (passed(voltet_array_length(contents, place)))
          read (unit, *, iostat=status, iomsg=message) passed
        end if
      end do
    end do
  end subroutine

  ! Each line: VTK's type, how many points, and these, from 0.
  subroutine read_cells(reading, unit, contents, status, message)
    type(voltet_reading), intent(in) :: reading
    integer, intent(in) :: unit
    type(voltet_contents), intent(in) :: contents
    integer, intent(out) :: status
    character(*), intent(inout) :: message
    integer(c_int8_t), pointer :: types(:)
    integer(c_int64_t), pointer :: offsets(:)
    integer(c_int32_t), pointer :: connectivity(:)
    integer(c_int32_t), allocatable :: own(:)
    integer(c_int64_t) :: cell, last, i
    integer :: kind, count
    types => voltet_read_types(reading)
    offsets => voltet_read_offsets(reading)
    connectivity => voltet_read_connectivity(reading)
    status = 0
    last = 0
    if (associated(offsets)) offsets(1) = 0
    allocate (own(contents%connectivity_count))
    do cell = 1, contents%cell_count
      read (unit, *, iostat=status, iomsg=message) kind, count
      if (status /= 0) return
      if (count < 0 .or. last + count > contents%connectivity_count) then
        message = "the cells have more points than the header says"
        status = 1
        return
      end if
      backspace (unit)
      read (unit, *, iostat=status, iomsg=message) kind, count, (own(last + i), i=1, count)
      if (status /= 0) return
      last = last + count
      if (associated(types)) types(cell) = int(kind, c_int8_t)
      if (associated(offsets)) offsets(cell + 1) = last
    end do
    if (associated(connectivity)) connectivity = own
  end subroutine

  ! VOLTET_OK, or an error with the text of a statement that failed.
  function failed(host, status, message) result(code)
    type(voltet_host), intent(in) :: host
    integer, intent(in) :: status
    character(*), intent(in) :: message
    integer(c_int32_t) :: code
    code = VOLTET_OK
    if (status == 0) return
    call voltet_error(host, message)
    code = VOLTET_ERROR_CODE
  end function
end module
