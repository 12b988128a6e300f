! voltet_reader.f90: what the two functions of a reader in Fortran use, beside voltet_plugin.f90. What everything means stands in
! voltet_plugin.h. A whole plug-in: examples/plugin_fortran/reader.f90. Build one with
!
!     gfortran -O2 -shared -fPIC -Iinclude -o reader.so include/voltet_plugin.f90 include/voltet_reader.f90 reader.f90 \
!         include/voltet_plugin_fortran.c
!
! Yours has a subroutine `voltet_filters`, as voltet_plugin.f90 says, that calls
!
!     call voltet_add_reader("my-format", "What it reads.", c_funloc(contents), c_funloc(read_file), extensions=["mine"])
!
! and the functions `contents(reading, host) result(code) bind(c)`, which says what a file holds and ends with
! voltet_describe_contents, and `read_file(reading, host) result(code) bind(c)`, which writes what is asked for to the arrays that
! voltet_read_points and so on give. Numbers of points count from 0, as in C; places of parameters and arrays count from 1.
module voltet_reader
  use, intrinsic :: iso_c_binding
  use voltet_plugin
  implicit none
  private

  public :: voltet_reading, voltet_contents
  public :: voltet_path, voltet_add_array, voltet_array_count, voltet_array_length
  public :: voltet_describe_contents, voltet_is_as_described
  public :: voltet_read_points, voltet_read_types, voltet_read_offsets, voltet_read_connectivity, voltet_read_tetrahedra
  public :: voltet_read_array
  public :: voltet_number, voltet_integer, voltet_text

  ! Head of a grid: all cells are tetrahedra.
  integer(c_int32_t), parameter :: TETRAHEDRA = 1

  ! What is to be read.
  type, bind(c) :: voltet_reading
    integer(c_int32_t) :: size, reserved
    type(c_ptr) :: path
    integer(c_int64_t) :: step
    type(c_ptr) :: values
    type(c_funptr) :: describe
    type(c_ptr) :: buffers, context
  end type

  ! What a file holds, for voltet_describe_contents. `connectivity_count`: numbers of points of all cells together; where
  ! `is_tetrahedra`, it is not looked at. `scalar`: the array that is drawn where the pipeline names none.
  type :: voltet_contents
    integer(c_int64_t) :: point_count = 0, cell_count = 0, connectivity_count = 0
    logical :: is_tetrahedra = .false.
    real(c_double), allocatable :: times(:)
    character(:), allocatable :: scalar, format
    type(array_of_contents), allocatable, private :: arrays(:)
  end type

  type, private :: array_of_contents
    character(:), allocatable :: name
    integer :: components
    logical :: on_cells
  end type

  type, bind(c) :: array_head
    integer(c_int32_t) :: size = 0, component_count = 0
    type(c_ptr) :: name = c_null_ptr
    integer(c_int32_t) :: on_cells = 0, reserved = 0
  end type

  type, bind(c) :: grid_head
    integer(c_int32_t) :: size = 0, flags = 0
    integer(c_int64_t) :: point_count = 0, cell_count = 0, connectivity_count = 0
    integer(c_int32_t) :: array_count = 0, step_count = 0
    type(c_ptr) :: arrays = c_null_ptr, scalar = c_null_ptr, times = c_null_ptr, format = c_null_ptr
  end type

  type, bind(c) :: grid_buffers
    integer(c_int32_t) :: size, array_count
    integer(c_int64_t) :: point_count, cell_count, connectivity_count
    type(c_ptr) :: points, tetrahedra, types, offsets, connectivity, arrays
  end type

  ! The parameter at a place, from 1, of a reading.
  interface voltet_number
    module procedure number_of_reading
  end interface
  interface voltet_integer
    module procedure integer_of_reading
  end interface
  interface voltet_text
    module procedure text_of_reading
  end interface

  abstract interface
    function describe_function(reading, head) result(code) bind(c)
      import :: voltet_reading, grid_head, c_int32_t
      type(voltet_reading), intent(in) :: reading
      type(grid_head), intent(in) :: head
      integer(c_int32_t) :: code
    end function
  end interface

contains

  function number_of_reading(reading, place) result(value)
    type(voltet_reading), intent(in) :: reading
    integer, intent(in) :: place
    real(c_double) :: value
    type(voltet_values), pointer :: values
    call c_f_pointer(reading%values, values)
    value = voltet_number(values, place)
  end function

  function integer_of_reading(reading, place) result(value)
    type(voltet_reading), intent(in) :: reading
    integer, intent(in) :: place
    integer(c_int64_t) :: value
    type(voltet_values), pointer :: values
    call c_f_pointer(reading%values, values)
    value = voltet_integer(values, place)
  end function

  function text_of_reading(reading, place) result(value)
    type(voltet_reading), intent(in) :: reading
    integer, intent(in) :: place
    character(:), allocatable :: value
    type(voltet_values), pointer :: values
    call c_f_pointer(reading%values, values)
    value = voltet_text(values, place)
  end function

  ! The file that is to be read.
  function voltet_path(reading) result(path)
    type(voltet_reading), intent(in) :: reading
    character(:), allocatable :: path
    path = voltet_text_at(reading%path)
  end function

  ! Adds an array to what a file holds.
  subroutine voltet_add_array(contents, name, components, on_cells)
    type(voltet_contents), intent(inout) :: contents
    character(*), intent(in) :: name
    integer, intent(in) :: components
    logical, intent(in) :: on_cells
    type(array_of_contents) :: added
    added%name = name
    added%components = components
    added%on_cells = on_cells
    if (.not. allocated(contents%arrays)) allocate (contents%arrays(0))
    contents%arrays = [contents%arrays, added]
  end subroutine

  function voltet_array_count(contents) result(count)
    type(voltet_contents), intent(in) :: contents
    integer :: count
    count = 0
    if (allocated(contents%arrays)) count = size(contents%arrays)
  end function

  ! How many numbers the array at a place, from 1, has: components times points or cells.
  function voltet_array_length(contents, place) result(length)
    type(voltet_contents), intent(in) :: contents
    integer, intent(in) :: place
    integer(c_int64_t) :: length
    length = merge(contents%cell_count, contents%point_count, contents%arrays(place)%on_cells)*contents%arrays(place)%components
  end function

  ! Says what the file holds: what the first function of a reader ends with.
  function voltet_describe_contents(reading, contents) result(code)
    type(voltet_reading), intent(in) :: reading
    type(voltet_contents), intent(in), target :: contents
    integer(c_int32_t) :: code
    procedure(describe_function), pointer :: describe
    type(grid_head) :: head
    type(array_head), allocatable, target :: heads(:)
    character(kind=c_char), allocatable, target :: scalar(:), format(:), names(:, :)
    integer :: i, longest
    head%size = int(c_sizeof(head), c_int32_t)
    head%point_count = contents%point_count
    head%cell_count = contents%cell_count
    if (contents%is_tetrahedra) head%flags = TETRAHEDRA
    if (.not. contents%is_tetrahedra) head%connectivity_count = contents%connectivity_count
    if (allocated(contents%times)) then
      head%step_count = size(contents%times)
      if (size(contents%times) > 0) head%times = c_loc(contents%times)
    end if
    if (allocated(contents%scalar)) then
      scalar = characters(contents%scalar, len(contents%scalar))
      head%scalar = c_loc(scalar)
    end if
    if (allocated(contents%format)) then
      format = characters(contents%format, len(contents%format))
      head%format = c_loc(format)
    end if
    if (allocated(contents%arrays)) then
      longest = 0
      do i = 1, size(contents%arrays)
        longest = max(longest, len(contents%arrays(i)%name))
      end do
      allocate (heads(size(contents%arrays)), names(longest + 1, size(contents%arrays)))
      do i = 1, size(heads)
        names(:, i) = characters(contents%arrays(i)%name, longest)
        heads(i)%size = int(c_sizeof(heads(i)), c_int32_t)
        heads(i)%component_count = contents%arrays(i)%components
        heads(i)%name = c_loc(names(1, i))
        heads(i)%on_cells = merge(1, 0, contents%arrays(i)%on_cells)
      end do
      head%array_count = size(heads)
      head%arrays = c_loc(heads)
    end if
    call c_f_procpointer(reading%describe, describe)
    code = describe(reading, head)
  end function

  ! A text as C has it, with room for so many characters.
  function characters(text, room) result(copy)
    character(*), intent(in) :: text
    integer, intent(in) :: room
    character(kind=c_char) :: copy(room + 1)
    integer :: i
    copy = c_null_char
    do i = 1, len(text)
      copy(i) = text(i:i)
    end do
  end function

  ! Whether a file is still as large as it was when it was described: what the second function of a reader begins with.
  function voltet_is_as_described(reading, contents) result(is_same)
    type(voltet_reading), intent(in) :: reading
    type(voltet_contents), intent(in) :: contents
    logical :: is_same
    type(grid_buffers), pointer :: b
    call c_f_pointer(reading%buffers, b)
    is_same = b%point_count == contents%point_count .and. b%cell_count == contents%cell_count .and. &
      b%array_count == voltet_array_count(contents) .and. &
      (contents%is_tetrahedra .or. b%connectivity_count == contents%connectivity_count)
  end function

  ! Where the points go: (3, point_count); null where they are not asked for, as all that follow.
  function voltet_read_points(reading) result(points)
    type(voltet_reading), intent(in) :: reading
    real(c_double), pointer :: points(:, :)
    type(grid_buffers), pointer :: b
    nullify (points)
    call c_f_pointer(reading%buffers, b)
    if (c_associated(b%points)) call c_f_pointer(b%points, points, [3_c_int64_t, b%point_count])
  end function

  ! Where VTK's type of each cell goes.
  function voltet_read_types(reading) result(types)
    type(voltet_reading), intent(in) :: reading
    integer(c_int8_t), pointer :: types(:)
    type(grid_buffers), pointer :: b
    nullify (types)
    call c_f_pointer(reading%buffers, b)
    if (c_associated(b%types)) call c_f_pointer(b%types, types, [b%cell_count])
  end function

  ! Where the offsets go: the points of cell i are connectivity(offsets(i) + 1 : offsets(i + 1)).
  function voltet_read_offsets(reading) result(offsets)
    type(voltet_reading), intent(in) :: reading
    integer(c_int64_t), pointer :: offsets(:)
    type(grid_buffers), pointer :: b
    nullify (offsets)
    call c_f_pointer(reading%buffers, b)
    if (c_associated(b%offsets)) call c_f_pointer(b%offsets, offsets, [b%cell_count + 1])
  end function

  ! Where the points of the cells go, numbers from 0.
  function voltet_read_connectivity(reading) result(connectivity)
    type(voltet_reading), intent(in) :: reading
    integer(c_int32_t), pointer :: connectivity(:)
    type(grid_buffers), pointer :: b
    nullify (connectivity)
    call c_f_pointer(reading%buffers, b)
    if (c_associated(b%connectivity)) call c_f_pointer(b%connectivity, connectivity, [b%connectivity_count])
  end function

  ! Where the points of tetrahedra go: (4, cell_count), numbers from 0.
  function voltet_read_tetrahedra(reading) result(cells)
    type(voltet_reading), intent(in) :: reading
    integer(c_int32_t), pointer :: cells(:, :)
    type(grid_buffers), pointer :: b
    nullify (cells)
    call c_f_pointer(reading%buffers, b)
    if (c_associated(b%tetrahedra)) call c_f_pointer(b%tetrahedra, cells, [4_c_int64_t, b%cell_count])
  end function

  ! Where the values of the array at a place, from 1, go: (components, points or cells).
  function voltet_read_array(reading, contents, place) result(values)
    type(voltet_reading), intent(in) :: reading
    type(voltet_contents), intent(in) :: contents
    integer, intent(in) :: place
    real(c_double), pointer :: values(:, :)
    type(grid_buffers), pointer :: b
    type(c_ptr), pointer :: arrays(:)
    nullify (values)
    call c_f_pointer(reading%buffers, b)
    call c_f_pointer(b%arrays, arrays, [b%array_count])
    if (.not. c_associated(arrays(place))) return
    associate (components => int(contents%arrays(place)%components, c_int64_t))
      call c_f_pointer(arrays(place), values, [components, voltet_array_length(contents, place)/components])
    end associate
  end function
end module
