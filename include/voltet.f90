! voltet.f90: the renderer of voltet for Fortran (2003 and later). Each name is that of include/voltet.h, which says what it means.
!
!     gfortran voltet.f90 program.f90 $(pkg-config --libs voltet) -o program
!
! Arrays of a grid are handed over by c_loc, so they need the attribute `target`; points are real(c_double) :: points(3, n), and
! tetrahedra integer(c_int32_t) :: corners(4, n), whose numbers begin at 0. Texts end with a 0 character: voltet_text(...) adds it.
module voltet
  use, intrinsic :: iso_c_binding
  implicit none
  private :: length_of

  integer(c_int), parameter :: voltet_done = 0, voltet_failed = 1, voltet_wrong = 2, voltet_stopped = 3, voltet_panic = 4

  type, bind(c) :: voltet_array
    integer(c_size_t) :: size = 0
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: values = c_null_ptr
    integer(c_size_t) :: component_count = 1
    integer(c_int) :: on_cells = 0
  end type

  type, bind(c) :: voltet_grid_source
    integer(c_size_t) :: size = 0
    integer(c_size_t) :: point_count = 0
    type(c_ptr) :: points = c_null_ptr
    integer(c_size_t) :: array_count = 0
    type(c_ptr) :: arrays = c_null_ptr
    type(c_ptr) :: scalar = c_null_ptr
    integer(c_size_t) :: cell_count = 0
    type(c_ptr) :: tetrahedra = c_null_ptr
    type(c_ptr) :: types = c_null_ptr
    type(c_ptr) :: offsets = c_null_ptr
    type(c_ptr) :: connectivity = c_null_ptr
    type(c_ptr) :: connectivity_u32 = c_null_ptr
    integer(c_size_t) :: connectivity_count = 0
    type(c_ptr) :: faces = c_null_ptr
    type(c_ptr) :: face_locations = c_null_ptr
    integer(c_size_t) :: faces_count = 0
    type(c_ptr) :: degrees = c_null_ptr
    type(c_ptr) :: ghost = c_null_ptr
    integer(c_int) :: subdivision = 0
    integer(c_int) :: constant_cells = 0
    type(c_funptr) :: release = c_null_funptr
    type(c_ptr) :: user = c_null_ptr
    type(c_ptr) :: global_ids = c_null_ptr
    type(c_ptr) :: further_pieces = c_null_ptr
    integer(c_size_t) :: further_piece_count = 0
  end type

  type, bind(c) :: voltet_grid_info
    integer(c_size_t) :: size = 0
    integer(c_int64_t) :: point_count = 0
    integer(c_int64_t) :: tetrahedron_count = 0
    integer(c_int64_t) :: bytes_lent = 0
    integer(c_int64_t) :: bytes_copied = 0
    real(c_double) :: low(3) = 0, high(3) = 0
    real(c_double) :: scalar(2) = 0
  end type

  type, bind(c) :: voltet_camera
    integer(c_size_t) :: size = 0
    real(c_double) :: eye(3) = 0, target(3) = 0, up(3) = 0
    real(c_double) :: fov_y = 0, height = 0, near_plane = 0
    integer(c_int32_t) :: pixels(2) = 0
    integer(c_int32_t) :: samples = 0
  end type

  type, bind(c) :: voltet_image
    integer(c_size_t) :: size = 0
    integer(c_size_t) :: width = 0, height = 0
    type(c_ptr) :: rgba = c_null_ptr
    integer(c_size_t) :: rgba_stride = 0
    type(c_ptr) :: srgb = c_null_ptr
    integer(c_size_t) :: srgb_stride = 0
    real(c_double) :: background(3) = 0
  end type

  type, bind(c) :: voltet_follow
    integer(c_size_t) :: size = 0
    type(c_ptr) :: user = c_null_ptr
    type(c_funptr) :: progress = c_null_funptr
    type(c_funptr) :: cancelled = c_null_funptr
  end type

  interface
    function voltet_version() bind(c)
      import
      type(c_ptr) :: voltet_version
    end function

    function voltet_interface() bind(c)
      import
      integer(c_int32_t) :: voltet_interface
    end function

    function voltet_open(session) bind(c) result(status)
      import
      type(c_ptr), intent(out) :: session
      integer(c_int) :: status
    end function

    function voltet_close(session) bind(c) result(status)
      import
      type(c_ptr), value :: session
      integer(c_int) :: status
    end function

    function voltet_error_text(session) bind(c) result(text)
      import
      type(c_ptr), value :: session
      type(c_ptr) :: text
    end function

    function voltet_load(session, path) bind(c) result(status)
      import
      type(c_ptr), value :: session
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function

    function voltet_load_text(session, pipeline, folder) bind(c) result(status)
      import
      type(c_ptr), value :: session
      character(kind=c_char), intent(in) :: pipeline(*), folder(*)
      integer(c_int) :: status
    end function

    function voltet_set(session, option) bind(c) result(status)
      import
      type(c_ptr), value :: session
      character(kind=c_char), intent(in) :: option(*)
      integer(c_int) :: status
    end function

    function voltet_set_node(session, node, parameters) bind(c) result(status)
      import
      type(c_ptr), value :: session
      character(kind=c_char), intent(in) :: node(*), parameters(*)
      integer(c_int) :: status
    end function

    ! The node is c_null_ptr, or the place of a text.
    function voltet_set_camera(session, node, camera) bind(c) result(status)
      import
      type(c_ptr), value :: session, node
      type(voltet_camera), intent(in) :: camera
      integer(c_int) :: status
    end function

    function voltet_grid_new(session, source, grid) bind(c) result(status)
      import
      type(c_ptr), value :: session
      type(voltet_grid_source), intent(in) :: source
      type(c_ptr), intent(out) :: grid
      integer(c_int) :: status
    end function

    function voltet_grid_about(grid, info) bind(c) result(status)
      import
      type(c_ptr), value :: grid
      type(voltet_grid_info), intent(inout) :: info
      integer(c_int) :: status
    end function

    subroutine voltet_grid_release(grid) bind(c)
      import
      type(c_ptr), value :: grid
    end subroutine

    function voltet_set_grid(session, node, grid) bind(c) result(status)
      import
      type(c_ptr), value :: session, node, grid
      integer(c_int) :: status
    end function

    function voltet_picture_size(session, node, width, height) bind(c) result(status)
      import
      type(c_ptr), value :: session, node
      integer(c_size_t), intent(out) :: width, height
      integer(c_int) :: status
    end function

    ! What follows the picture is c_null_ptr, or the place of a voltet_follow.
    function voltet_render(session, node, image, follow) bind(c) result(status)
      import
      type(c_ptr), value :: session, node
      type(voltet_image), intent(in) :: image
      type(c_ptr), value :: follow
      integer(c_int) :: status
    end function

    function voltet_report(session, buffer, size) bind(c) result(length)
      import
      type(c_ptr), value :: session
      character(kind=c_char), intent(inout) :: buffer(*)
      integer(c_size_t), value :: size
      integer(c_size_t) :: length
    end function

    function voltet_warnings(session, buffer, size) bind(c) result(length)
      import
      type(c_ptr), value :: session
      character(kind=c_char), intent(inout) :: buffer(*)
      integer(c_size_t), value :: size
      integer(c_size_t) :: length
    end function

    pure function length_of(text) bind(c, name="strlen") result(length)
      import
      type(c_ptr), value, intent(in) :: text
      integer(c_size_t) :: length
    end function
  end interface

contains

  ! A text for the functions above.
  pure function voltet_text(text) result(ended)
    character(len=*), intent(in) :: text
    character(kind=c_char, len=len_trim(text) + 1) :: ended
    ended = trim(text)//c_null_char
  end function

  ! What was wrong with the session's last call that failed.
  function voltet_error(session) result(text)
    type(c_ptr), intent(in) :: session
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: characters(:)
    type(c_ptr) :: place
    integer :: i, count
    place = voltet_error_text(session)
    count = int(length_of(place))
    call c_f_pointer(place, characters, [count])
    allocate (character(len=count) :: text)
    do i = 1, count
      text(i:i) = characters(i)
    end do
  end function

end module
