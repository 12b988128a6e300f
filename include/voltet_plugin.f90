! voltet_plugin.f90: gradient filters and readers for voltet in Fortran. What everything means stands in voltet_plugin.h; this module
! is the same with Fortran's arrays and texts. Whole plug-ins: examples/plugin_fortran/least_squares.f90 (a gradient filter),
! reader.f90. Build one with
!
!     gfortran -O2 -shared -fPIC -Iinclude -o filter.so include/voltet_plugin.f90 filter.f90 include/voltet_plugin_fortran.c
!
! (the last file is the one thing that Fortran cannot write: a constant with addresses of functions.) Yours has a subroutine
!
!     subroutine voltet_filters() bind(c)
!       call voltet_describe_plugin("my filters", "1.0")
!       call voltet_add_filter("my-filter", "What it does.", c_funloc(my_gradient), needs=VOLTET_NEEDS_NEIGHBOURS)
!       call voltet_add_number("power", "what it is", default=1.0_c_double, min=0.0_c_double, max=4.0_c_double)
!     end subroutine
!
! and for each filter a function `my_gradient(call, host) result(code) bind(c)`. A reader is added by voltet_add_reader; what its two
! functions use stands in voltet_reader.f90. Numbers of points and cells in `cells`, `neighbours` and the starts count from 0, as in
! C; parameters count from 1.
module voltet_plugin
  use, intrinsic :: iso_c_binding
  implicit none
  private

  public :: voltet_host, voltet_call, voltet_values
  public :: voltet_describe_plugin, voltet_add_filter, voltet_add_reader, voltet_add_check
  public :: voltet_add_boolean, voltet_add_integer, voltet_add_number, voltet_add_text, voltet_add_point_array, voltet_add_choice
  public :: voltet_points, voltet_cells, voltet_scalar, voltet_gradient, voltet_point_array
  public :: voltet_neighbours, voltet_cells_of_points, voltet_second_rings, voltet_at_boundary
  public :: voltet_number, voltet_integer, voltet_text, voltet_text_at
  public :: voltet_progress, voltet_cancelled, voltet_error, voltet_fallback, voltet_parallel_for

  ! What functions return.
  integer(c_int32_t), parameter, public :: VOLTET_OK = 0, VOLTET_CANCELLED_CODE = 1, VOLTET_ERROR_CODE = 2
  ! What a filter needs beside points, cells and scalar.
  integer(c_int32_t), parameter, public :: VOLTET_NEEDS_NEIGHBOURS = 1, VOLTET_NEEDS_CELLS_OF_POINTS = 2, &
    VOLTET_NEEDS_BOUNDARY = 4, VOLTET_NEEDS_SECOND_RINGS = 8

  integer(c_int32_t), parameter :: BOOLEAN = 1, WHOLE = 2, NUMBER = 3, CHOICE = 4, TEXT = 5, POINT_ARRAY = 7
  integer(c_int32_t), parameter :: REQUIRED = 1
  integer, parameter :: FILTERS_MOST = 32, PARAMETERS_MOST = 64, READERS_MOST = 16, EXTENSIONS_MOST = 16

  type, bind(c) :: voltet_host
    integer(c_int32_t) :: size, major, minor, patch
    integer(c_int32_t) :: thread_count, reserved
    type(c_ptr) :: program, context
    type(c_funptr) :: progress, cancelled, error, fallback, parallel_for
  end type

  type, bind(c) :: voltet_values
    integer(c_int32_t) :: size, count
    type(c_ptr) :: integers, numbers, texts, vectors, lengths
  end type

  type, bind(c) :: voltet_call
    integer(c_int32_t) :: size, reserved
    integer(c_int64_t) :: point_count, cell_count
    type(c_ptr) :: points, cells, neighbour_starts, neighbours, cell_starts, cells_of_points, scalar, arrays, values, gradient
    type(c_ptr) :: at_boundary, second_ring_starts, second_rings
  end type

  type, bind(c) :: parameter_of
    integer(c_int32_t) :: size = 0, kind = 0
    type(c_ptr) :: name = c_null_ptr, unit = c_null_ptr, help = c_null_ptr
    integer(c_int32_t) :: flags = 0, length = 0
    real(c_double) :: min = 0, max = 0, number = 0
    type(c_ptr) :: text = c_null_ptr, numbers = c_null_ptr, unset = c_null_ptr
    integer(c_int32_t) :: word_count = 0, reserved = 0
    type(c_ptr) :: words = c_null_ptr, meanings = c_null_ptr
  end type

  type, bind(c) :: filter_of
    integer(c_int32_t) :: size = 0, needs = 0
    type(c_ptr) :: name = c_null_ptr, summary = c_null_ptr
    integer(c_int32_t) :: parameter_count = 0, reserved = 0
    type(c_ptr) :: parameters = c_null_ptr
    type(c_funptr) :: check = c_null_funptr, gradient = c_null_funptr
  end type

  type, bind(c) :: reader_of
    integer(c_int32_t) :: size = 0, reserved = 0
    type(c_ptr) :: name = c_null_ptr, summary = c_null_ptr
    integer(c_int32_t) :: parameter_count = 0, extension_count = 0
    type(c_ptr) :: parameters = c_null_ptr
    type(c_funptr) :: check = c_null_funptr, inspect = c_null_funptr, read = c_null_funptr
    type(c_ptr) :: extensions = c_null_ptr, magic = c_null_ptr
    integer(c_int32_t) :: magic_length = 0, reserved_too = 0
  end type

  type, bind(c) :: factory_of
    integer(c_int32_t) :: size = 0, reserved = 0
    type(c_funptr) :: item_count = c_null_funptr, item = c_null_funptr
  end type

  type, bind(c) :: plugin_of
    integer(c_int32_t) :: size = 0, reserved = 0
    type(c_ptr) :: name = c_null_ptr, version = c_null_ptr
  end type

  ! What was described. Texts stay as long as the program.
  type(plugin_of), target, save :: plugin
  type(factory_of), target, save :: filter_factory, reader_factory
  type(filter_of), target, save :: filters(FILTERS_MOST)
  type(reader_of), target, save :: readers(READERS_MOST)
  type(parameter_of), target, save :: parameters(PARAMETERS_MOST, FILTERS_MOST + READERS_MOST)
  integer, save :: filter_total = 0, reader_total = 0
  logical, save :: too_many = .false.
  ! Of the filter or reader that was added last.
  type(parameter_of), pointer, save :: own_parameters(:) => null()
  integer(c_int32_t), pointer, save :: own_count => null()
  type(c_funptr), pointer, save :: own_check => null()

  ! The parameter at a place, from 1: as a number; a whole number, 0 or 1, or the place of a choice's word, from 0; as a text, empty
  ! where it is not set. Of a voltet_call, or of the voltet_values of a check.
  interface voltet_number
    module procedure number_of_call, number_of_values
  end interface
  interface voltet_integer
    module procedure integer_of_call, integer_of_values
  end interface
  interface voltet_text
    module procedure text_of_call, text_of_values
  end interface

  abstract interface
    subroutine progress_function(host, fraction) bind(c)
      import :: voltet_host, c_double
      type(voltet_host), intent(in) :: host
      real(c_double), value :: fraction
    end subroutine
    function cancelled_function(host) result(is_cancelled) bind(c)
      import :: voltet_host, c_int32_t
      type(voltet_host), intent(in) :: host
      integer(c_int32_t) :: is_cancelled
    end function
    subroutine error_function(host, text) bind(c)
      import :: voltet_host, c_char
      type(voltet_host), intent(in) :: host
      character(kind=c_char), intent(in) :: text(*)
    end subroutine
    subroutine fallback_function(host, what, point_count) bind(c)
      import :: voltet_host, c_char, c_int64_t
      type(voltet_host), intent(in) :: host
      character(kind=c_char), intent(in) :: what(*)
      integer(c_int64_t), value :: point_count
    end subroutine
    function parallel_for_function(host, count, chunk, body, user) result(code) bind(c)
      import :: voltet_host, c_int64_t, c_int32_t, c_funptr, c_ptr
      type(voltet_host), intent(in) :: host
      integer(c_int64_t), value :: count, chunk
      type(c_funptr), value :: body
      type(c_ptr), value :: user
      integer(c_int32_t) :: code
    end function
  end interface

  interface
    ! Yours: describes the plug-in and adds its filters.
    subroutine voltet_filters() bind(c)
    end subroutine
    function c_length(text) result(length) bind(c, name="strlen")
      import :: c_ptr, c_size_t
      type(c_ptr), value :: text
      integer(c_size_t) :: length
    end function
  end interface

contains

  ! ---- Description ------------------------------------------------------------------------------------------------------------

  ! The name of the plug-in, for messages and pictures, and its version.
  subroutine voltet_describe_plugin(name, version)
    character(*), intent(in) :: name, version
    plugin%size = int(c_sizeof(plugin), c_int32_t)
    plugin%name = kept(name)
    plugin%version = kept(version)
  end subroutine

  ! Adds a filter: its name in pipeline files, what it does, c_funloc of its function, what it needs. What is added next is its.
  subroutine voltet_add_filter(name, summary, gradient, needs)
    character(*), intent(in) :: name, summary
    type(c_funptr), value :: gradient
    integer(c_int32_t), intent(in), optional :: needs
    type(filter_of) :: added
    if (filter_total == FILTERS_MOST) then
      too_many = .true.
      return
    end if
    filter_total = filter_total + 1
    added%size = int(c_sizeof(added), c_int32_t)
    added%name = kept(name)
    added%summary = kept(summary)
    added%gradient = gradient
    if (present(needs)) added%needs = needs
    own_parameters => parameters(:, filter_total)
    added%parameters = c_loc(own_parameters(1))
    filters(filter_total) = added
    own_count => filters(filter_total)%parameter_count
    own_check => filters(filter_total)%check
  end subroutine

  ! Adds a reader: its type in pipeline files, what it reads, c_funloc of the function that says what a file holds and of the one
  ! that reads it, the ends of the names of its files, and how these begin. What is added next is its.
  subroutine voltet_add_reader(name, summary, contents, read, extensions, magic)
    character(*), intent(in) :: name, summary, extensions(:)
    type(c_funptr), value :: contents, read
    character(*), intent(in), optional :: magic
    type(reader_of) :: added
    if (reader_total == READERS_MOST .or. size(extensions) > EXTENSIONS_MOST) then
      too_many = .true.
      return
    end if
    reader_total = reader_total + 1
    added%size = int(c_sizeof(added), c_int32_t)
    added%name = kept(name)
    added%summary = kept(summary)
    added%inspect = contents
    added%read = read
    added%extension_count = size(extensions)
    added%extensions = list(extensions)
    if (present(magic)) then
      added%magic = kept(magic)
      added%magic_length = len_trim(magic)
    end if
    own_parameters => parameters(:, FILTERS_MOST + reader_total)
    added%parameters = c_loc(own_parameters(1))
    readers(reader_total) = added
    own_count => readers(reader_total)%parameter_count
    own_check => readers(reader_total)%check
  end subroutine

  ! c_funloc of a `function my_check(values, host) result(code) bind(c)`, which checks what single parameters cannot say.
  subroutine voltet_add_check(check)
    type(c_funptr), value :: check
    if (associated(own_check)) own_check = check
  end subroutine

  subroutine voltet_add_boolean(name, help, default)
    character(*), intent(in) :: name, help
    logical, intent(in) :: default
    type(parameter_of) :: added
    added%kind = BOOLEAN
    added%number = merge(1.0_c_double, 0.0_c_double, default)
    call add(added, name, help)
  end subroutine

  ! Without a default the pipeline file must give it; without `min` and `max` there are no limits. `least` and
  ! `most` are their former names.
  subroutine voltet_add_integer(name, help, default, min, max, unit, least, most)
    character(*), intent(in) :: name, help
    integer(c_int64_t), intent(in), optional :: default, min, max, least, most
    character(*), intent(in), optional :: unit
    type(parameter_of) :: added
    added%kind = WHOLE
    if (present(default)) added%number = real(default, c_double)
    if (.not. present(default)) added%flags = REQUIRED
    if (present(min) .or. present(max) .or. present(least) .or. present(most)) then
      added%min = -huge(added%min)
      added%max = huge(added%max)
      if (present(min)) added%min = real(min, c_double)
      if (present(max)) added%max = real(max, c_double)
      if (present(least)) added%min = real(least, c_double)
      if (present(most)) added%max = real(most, c_double)
    end if
    call add(added, name, help, unit)
  end subroutine

  ! Without a default the pipeline file must give it; without `min` and `max` there are no limits. `least` and
  ! `most` are their former names.
  subroutine voltet_add_number(name, help, default, min, max, unit, least, most)
    character(*), intent(in) :: name, help
    real(c_double), intent(in), optional :: default, min, max, least, most
    character(*), intent(in), optional :: unit
    type(parameter_of) :: added
    added%kind = NUMBER
    if (present(default)) added%number = default
    if (.not. present(default)) added%flags = REQUIRED
    if (present(min) .or. present(max) .or. present(least) .or. present(most)) then
      added%min = -huge(added%min)
      added%max = huge(added%max)
      if (present(min)) added%min = min
      if (present(max)) added%max = max
      if (present(least)) added%min = least
      if (present(most)) added%max = most
    end if
    call add(added, name, help, unit)
  end subroutine

  ! One of several words, each with its meaning.
  subroutine voltet_add_choice(name, help, default, words, meanings)
    character(*), intent(in) :: name, help, default, words(:), meanings(:)
    type(parameter_of) :: added
    added%kind = CHOICE
    added%text = kept(default)
    added%word_count = size(words)
    added%words = list(words)
    added%meanings = list(meanings)
    call add(added, name, help)
  end subroutine

  ! Without a default, `unset` says what it means where the pipeline file does not give it; without both it must.
  subroutine voltet_add_text(name, help, default, unset)
    character(*), intent(in) :: name, help
    character(*), intent(in), optional :: default, unset
    type(parameter_of) :: added
    added%kind = TEXT
    call set_text(added, default, unset)
    call add(added, name, help)
  end subroutine

  ! The name of an array of the data with so many components a point; the values: voltet_point_array.
  subroutine voltet_add_point_array(name, help, components, default, unset)
    character(*), intent(in) :: name, help
    integer, intent(in) :: components
    character(*), intent(in), optional :: default, unset
    type(parameter_of) :: added
    added%kind = POINT_ARRAY
    added%length = components
    call set_text(added, default, unset)
    call add(added, name, help)
  end subroutine

  subroutine set_text(added, default, unset)
    type(parameter_of), intent(inout) :: added
    character(*), intent(in), optional :: default, unset
    if (present(default)) then
      added%text = kept(default)
    else if (present(unset)) then
      added%unset = kept(unset)
    else
      added%flags = REQUIRED
    end if
  end subroutine

  subroutine add(added, name, help, unit)
    type(parameter_of), intent(inout) :: added
    character(*), intent(in) :: name, help
    character(*), intent(in), optional :: unit
    integer :: place
    if (.not. associated(own_count)) return
    place = own_count + 1
    if (place > PARAMETERS_MOST) then
      too_many = .true.
      return
    end if
    added%size = int(c_sizeof(added), c_int32_t)
    added%name = kept(name)
    added%help = kept(help)
    if (present(unit)) added%unit = kept(unit)
    own_parameters(place) = added
    own_count = place
  end subroutine

  ! A text as C has it, which stays as long as the program. Blanks at its end are left out.
  function kept(text) result(address)
    character(*), intent(in) :: text
    type(c_ptr) :: address
    character(kind=c_char), pointer :: copy(:)
    integer :: i
    allocate (copy(len_trim(text) + 1))
    do i = 1, len_trim(text)
      copy(i) = text(i:i)
    end do
    copy(len_trim(text) + 1) = c_null_char
    address = c_loc(copy)
  end function

  function list(texts) result(address)
    character(*), intent(in) :: texts(:)
    type(c_ptr) :: address
    type(c_ptr), pointer :: copy(:)
    integer :: i
    allocate (copy(size(texts)))
    do i = 1, size(texts)
      copy(i) = kept(texts(i))
    end do
    address = c_loc(copy)
  end function

  ! ---- What a call is given ---------------------------------------------------------------------------------------------------

  ! x, y, z of each point: (3, point_count).
  function voltet_points(call) result(points)
    type(voltet_call), intent(in) :: call
    real(c_double), pointer :: points(:, :)
    call c_f_pointer(call%points, points, [3_c_int64_t, call%point_count])
  end function

  ! The points of each cell: (4, cell_count).
  function voltet_cells(call) result(cells)
    type(voltet_call), intent(in) :: call
    integer(c_int32_t), pointer :: cells(:, :)
    call c_f_pointer(call%cells, cells, [4_c_int64_t, call%cell_count])
  end function

  ! One value a point.
  function voltet_scalar(call) result(scalar)
    type(voltet_call), intent(in) :: call
    real(c_double), pointer :: scalar(:)
    call c_f_pointer(call%scalar, scalar, [call%point_count])
  end function

  ! Out: the gradient at each point, (3, point_count).
  function voltet_gradient(call) result(gradient)
    type(voltet_call), intent(in) :: call
    real(c_double), pointer :: gradient(:, :)
    call c_f_pointer(call%gradient, gradient, [3_c_int64_t, call%point_count])
  end function

  ! Where VOLTET_NEEDS_NEIGHBOURS was asked for: the points that share an edge with point p (from 1) are
  ! neighbours(starts(p) + 1 : starts(p + 1)), numbers from 0.
  subroutine voltet_neighbours(call, starts, neighbours)
    type(voltet_call), intent(in) :: call
    integer(c_int64_t), pointer, intent(out) :: starts(:)
    integer(c_int32_t), pointer, intent(out) :: neighbours(:)
    call rows(call%neighbour_starts, call%neighbours, call%point_count, starts, neighbours)
  end subroutine

  ! Where VOLTET_NEEDS_CELLS_OF_POINTS was asked for: the cells that use point p, in the same form.
  subroutine voltet_cells_of_points(call, starts, cells)
    type(voltet_call), intent(in) :: call
    integer(c_int64_t), pointer, intent(out) :: starts(:)
    integer(c_int32_t), pointer, intent(out) :: cells(:)
    call rows(call%cell_starts, call%cells_of_points, call%point_count, starts, cells)
  end subroutine

  ! Where VOLTET_NEEDS_SECOND_RINGS was asked for: the points within two edges of point p, in the same form: first its neighbours.
  subroutine voltet_second_rings(call, starts, rings)
    type(voltet_call), intent(in) :: call
    integer(c_int64_t), pointer, intent(out) :: starts(:)
    integer(c_int32_t), pointer, intent(out) :: rings(:)
    call rows(call%second_ring_starts, call%second_rings, call%point_count, starts, rings)
  end subroutine

  ! Where VOLTET_NEEDS_BOUNDARY was asked for: 1 for each point of a face that one cell alone has, 0 for others.
  function voltet_at_boundary(call) result(flags)
    type(voltet_call), intent(in) :: call
    integer(c_int8_t), pointer :: flags(:)
    call c_f_pointer(call%at_boundary, flags, [call%point_count])
  end function

  subroutine rows(first, second, point_count, starts, items)
    type(c_ptr), intent(in) :: first, second
    integer(c_int64_t), intent(in) :: point_count
    integer(c_int64_t), pointer, intent(out) :: starts(:)
    integer(c_int32_t), pointer, intent(out) :: items(:)
    call c_f_pointer(first, starts, [point_count + 1])
    call c_f_pointer(second, items, [starts(point_count + 1)])
  end subroutine

  ! The values of the point array that a parameter names: (components, point_count); null where it names none.
  function voltet_point_array(call, place, components) result(values)
    type(voltet_call), intent(in) :: call
    integer, intent(in) :: place, components
    real(c_double), pointer :: values(:, :)
    type(c_ptr), pointer :: arrays(:)
    values => null()
    call c_f_pointer(call%arrays, arrays, [place])
    if (.not. c_associated(arrays(place))) return
    call c_f_pointer(arrays(place), values, [int(components, c_int64_t), call%point_count])
  end function

  function number_of_call(call, place) result(value)
    type(voltet_call), intent(in) :: call
    integer, intent(in) :: place
    real(c_double) :: value
    type(voltet_values), pointer :: values
    call c_f_pointer(call%values, values)
    value = number_of_values(values, place)
  end function

  function number_of_values(values, place) result(value)
    type(voltet_values), intent(in) :: values
    integer, intent(in) :: place
    real(c_double) :: value
    real(c_double), pointer :: numbers(:)
    call c_f_pointer(values%numbers, numbers, [place])
    value = numbers(place)
  end function

  function integer_of_call(call, place) result(value)
    type(voltet_call), intent(in) :: call
    integer, intent(in) :: place
    integer(c_int64_t) :: value
    type(voltet_values), pointer :: values
    call c_f_pointer(call%values, values)
    value = integer_of_values(values, place)
  end function

  function integer_of_values(values, place) result(value)
    type(voltet_values), intent(in) :: values
    integer, intent(in) :: place
    integer(c_int64_t) :: value
    integer(c_int64_t), pointer :: integers(:)
    call c_f_pointer(values%integers, integers, [place])
    value = integers(place)
  end function

  function text_of_call(call, place) result(value)
    type(voltet_call), intent(in) :: call
    integer, intent(in) :: place
    character(:), allocatable :: value
    type(voltet_values), pointer :: values
    call c_f_pointer(call%values, values)
    value = text_of_values(values, place)
  end function

  function text_of_values(values, place) result(value)
    type(voltet_values), intent(in) :: values
    integer, intent(in) :: place
    character(:), allocatable :: value
    type(c_ptr), pointer :: texts(:)
    call c_f_pointer(values%texts, texts, [place])
    value = voltet_text_at(texts(place))
  end function

  ! The text at an address; empty where that is none.
  function voltet_text_at(address) result(value)
    type(c_ptr), intent(in) :: address
    character(:), allocatable :: value
    character(kind=c_char), pointer :: text(:)
    integer :: i
    if (.not. c_associated(address)) then
      value = ""
      return
    end if
    call c_f_pointer(address, text, [c_length(address)])
    allocate (character(size(text)) :: value)
    do i = 1, size(text)
      value(i:i) = text(i)
    end do
  end function

  ! ---- What the host can do ---------------------------------------------------------------------------------------------------

  ! So much of the work (0 to 1) is done.
  subroutine voltet_progress(host, fraction)
    type(voltet_host), intent(in) :: host
    real(c_double), intent(in) :: fraction
    procedure(progress_function), pointer :: f
    call c_f_procpointer(host%progress, f)
    call f(host, fraction)
  end subroutine

  ! Whether the user asked to stop: return VOLTET_CANCELLED_CODE then.
  function voltet_cancelled(host) result(is_cancelled)
    type(voltet_host), intent(in) :: host
    logical :: is_cancelled
    procedure(cancelled_function), pointer :: f
    call c_f_procpointer(host%cancelled, f)
    is_cancelled = f(host) /= 0
  end function

  ! What went wrong: return VOLTET_ERROR_CODE after it.
  subroutine voltet_error(host, text)
    type(voltet_host), intent(in) :: host
    character(*), intent(in) :: text
    procedure(error_function), pointer :: f
    call c_f_procpointer(host%error, f)
    call f(host, trim(text)//c_null_char)
  end subroutine

  ! The filter did with less than it promises at so many points; `what` is followed by "at 12 points".
  subroutine voltet_fallback(host, what, point_count)
    type(voltet_host), intent(in) :: host
    character(*), intent(in) :: what
    integer(c_int64_t), intent(in) :: point_count
    procedure(fallback_function), pointer :: f
    call c_f_procpointer(host%fallback, f)
    call f(host, trim(what)//c_null_char, point_count)
  end subroutine

  ! Runs `body` (c_funloc of a `subroutine body(user, first, end, thread) bind(c)`, all by value: c_ptr, two c_int64_t, c_int32_t)
  ! over the numbers from 0 to count - 1 on the host's threads, from `first` to `end` - 1 at a time. Declare it `recursive`:
  ! several threads are in it at once.
  function voltet_parallel_for(host, count, chunk, body, user) result(code)
    type(voltet_host), intent(in) :: host
    integer(c_int64_t), intent(in) :: count, chunk
    type(c_funptr), value :: body
    type(c_ptr), value :: user
    integer(c_int32_t) :: code
    procedure(parallel_for_function), pointer :: f
    call c_f_procpointer(host%parallel_for, f)
    code = f(host, count, chunk, body, user)
  end function

  ! ---- What the entry in voltet_plugin_fortran.c calls ------------------------------------------------------------------------

  function voltet_fortran_init(path, host) result(described) bind(c)
    type(c_ptr), value :: path
    type(voltet_host), intent(in) :: host
    type(c_ptr) :: described
    described = c_null_ptr
    if (.not. c_associated(path)) return
    filter_total = 0
    reader_total = 0
    call voltet_filters()
    if (too_many) then
      call voltet_error(host, "there are more than 32 filters or 16 readers, or one with more than 64 parameters or 16 extensions")
      return
    end if
    described = c_loc(plugin)
  end function

  subroutine voltet_fortran_deinit() bind(c)
    filter_total = 0
    reader_total = 0
  end subroutine

  function voltet_fortran_factory(kind) result(address) bind(c)
    type(c_ptr), value :: kind
    type(c_ptr) :: address
    address = c_null_ptr
    select case (voltet_text_at(kind))
    case ("voltet.gradient-filters/1")
      if (filter_total > 0) address = factory(filter_factory, c_funloc(filter_count), c_funloc(filter_at))
    case ("voltet.readers/1")
      if (reader_total > 0) address = factory(reader_factory, c_funloc(reader_count), c_funloc(reader_at))
    end select
  end function

  function factory(filled, item_count, item) result(address)
    type(factory_of), intent(inout), target :: filled
    type(c_funptr), value :: item_count, item
    type(c_ptr) :: address
    filled%size = int(c_sizeof(filled), c_int32_t)
    filled%item_count = item_count
    filled%item = item
    address = c_loc(filled)
  end function

  function filter_count() result(count) bind(c)
    integer(c_int32_t) :: count
    count = filter_total
  end function

  function filter_at(place) result(address) bind(c)
    integer(c_int32_t), value :: place
    type(c_ptr) :: address
    address = c_null_ptr
    if (place >= 0 .and. place < filter_total) address = c_loc(filters(place + 1))
  end function

  function reader_count() result(count) bind(c)
    integer(c_int32_t) :: count
    count = reader_total
  end function

  function reader_at(place) result(address) bind(c)
    integer(c_int32_t), value :: place
    type(c_ptr) :: address
    address = c_null_ptr
    if (place >= 0 .and. place < reader_total) address = c_loc(readers(place + 1))
  end function
end module
