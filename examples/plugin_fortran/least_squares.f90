! fortran-least-squares: the linear function through each point that fits its neighbours best, the nearer ones more.
!
! As examples/plugin_c/least_squares.c, which says what it computes.
!
!     gfortran -O2 -shared -fPIC -I../../include -o least_squares.so ../../include/voltet_plugin.f90 least_squares.f90 \
!         ../../include/voltet_plugin_fortran.c
module least_squares
  use, intrinsic :: iso_c_binding
  use voltet_plugin
  implicit none

  integer, parameter :: real64 = c_double
  ! Under this pivot of the normal matrix, in parts of its trace, the neighbours lie in a plane.
  real(real64), parameter :: small = 1e-9_real64

  ! What all parts of the loop share.
  type :: work
    real(real64), pointer :: points(:, :), scalar(:), gradient(:, :)
    integer(c_int64_t), pointer :: starts(:)
    integer(c_int32_t), pointer :: neighbours(:)
    real(real64) :: power
    ! By threads: points where the neighbours lie in a plane.
    integer(c_int64_t), allocatable :: flat(:)
  end type

contains

  subroutine voltet_filters() bind(c)
    call voltet_describe_plugin("least squares in Fortran", "1.0.0")
    call voltet_add_filter("fortran-least-squares", &
      "Linear fit to the neighbouring points, weighted by a power of their distance, in Fortran.", &
      c_funloc(compute), needs=VOLTET_NEEDS_NEIGHBOURS)
    call voltet_add_number("power", "the power of the distance that a neighbour's weight is divided by; 1 is least-squares", &
      default=1.0_real64, min=0.0_real64, max=4.0_real64)
  end subroutine

  function compute(call, host) result(code) bind(c)
    type(voltet_call), intent(in) :: call
    type(voltet_host), intent(in) :: host
    integer(c_int32_t) :: code
    type(work), target :: w
    w%points => voltet_points(call)
    w%scalar => voltet_scalar(call)
    w%gradient => voltet_gradient(call)
    call voltet_neighbours(call, w%starts, w%neighbours)
    w%power = voltet_number(call, 1)
    allocate (w%flat(0:host%thread_count - 1), source=0_c_int64_t)
    code = voltet_parallel_for(host, call%point_count, 512_c_int64_t, c_funloc(fit), c_loc(w))
    call voltet_fallback(host, "set to zero: the neighbours lie in a plane or on a line", sum(w%flat))
    call voltet_progress(host, 1.0_real64)
  end function

  ! The points from `first` to `end` - 1, counted from 0.
  recursive subroutine fit(user, first, end, thread) bind(c)
    type(c_ptr), value :: user
    integer(c_int64_t), value :: first, end
    integer(c_int32_t), value :: thread
    type(work), pointer :: w
    integer(c_int64_t) :: p, k, q
    integer :: i
    real(real64) :: m(3, 3), b(3), d(3), square, weight
    logical :: is_solved
    call c_f_pointer(user, w)
    do p = first + 1, end
      m = 0
      b = 0
      do k = w%starts(p) + 1, w%starts(p + 1)
        q = w%neighbours(k) + 1
        d = w%points(:, q) - w%points(:, p)
        square = dot_product(d, d)
        if (.not. square > 0) cycle
        if (abs(w%power - 1) > 0) then
          weight = square**(-w%power)
        else
          weight = 1/square
        end if
        do i = 1, 3
          m(:, i) = m(:, i) + weight*d*d(i)
        end do
        b = b + weight*d*(w%scalar(q) - w%scalar(p))
      end do
      call solve(m, b, w%gradient(:, p), is_solved)
      if (.not. is_solved) then
        w%gradient(:, p) = 0
        w%flat(thread) = w%flat(thread) + 1
      end if
    end do
  end subroutine

  ! Solves m g = b, m symmetric, by L D L^T; not where a pivot is too small.
  pure subroutine solve(m, b, g, is_solved)
    real(real64), intent(in) :: m(3, 3), b(3)
    real(real64), intent(out) :: g(3)
    logical, intent(out) :: is_solved
    real(real64) :: limit, l1, l2, l3, d1, d2, r, y1, y2
    g = 0
    is_solved = .false.
    limit = small*(m(1, 1) + m(2, 2) + m(3, 3))
    if (.not. m(1, 1) > limit) return
    l1 = m(2, 1)/m(1, 1)
    l2 = m(3, 1)/m(1, 1)
    d1 = m(2, 2) - l1*m(2, 1)
    if (.not. d1 > limit) return
    r = m(3, 2) - l1*m(3, 1)
    l3 = r/d1
    d2 = m(3, 3) - l2*m(3, 1) - l3*r
    if (.not. d2 > limit) return
    y1 = b(2) - l1*b(1)
    y2 = b(3) - l2*b(1) - l3*y1
    g(3) = y2/d2
    g(2) = y1/d1 - l3*g(3)
    g(1) = b(1)/m(1, 1) - l1*g(2) - l2*g(3)
    is_solved = .true.
  end subroutine
end module
