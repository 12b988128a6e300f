! Heat conduction in a box, solved step by step, and drawn while it runs: by Catalyst, with voltet as its implementation.
!
!     gfortran -O2 heat.F90 -L$CATALYST/lib -lcatalyst -o heat
!     ./heat FOLDER scene.toml          FOLDER holds libcatalyst-voltet.so
!
! With MPI, each process solves a slab: mpifort -DHEAT_MPI ..., mpirun -n 4 ./heat ...
module catalyst_functions
  use, intrinsic :: iso_c_binding
  implicit none

  ! Of libcatalyst, whose Conduit has names of its own. Texts end with c_null_char.
  interface
    function create() bind(c, name="catalyst_conduit_node_create")
      import c_ptr
      type(c_ptr) :: create
    end function
    subroutine destroy(node) bind(c, name="catalyst_conduit_node_destroy")
      import c_ptr
      type(c_ptr), value :: node
    end subroutine
    function fetch(node, path) bind(c, name="catalyst_conduit_node_fetch")
      import c_ptr, c_char
      type(c_ptr), value :: node
      character(kind=c_char), intent(in) :: path(*)
      type(c_ptr) :: fetch
    end function
    subroutine set_text(node, path, text) bind(c, name="catalyst_conduit_node_set_path_char8_str")
      import c_ptr, c_char
      type(c_ptr), value :: node
      character(kind=c_char), intent(in) :: path(*), text(*)
    end subroutine
    subroutine set_integer(node, path, number) bind(c, name="catalyst_conduit_node_set_path_int64")
      import c_ptr, c_char, c_int64_t
      type(c_ptr), value :: node
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int64_t), value :: number
    end subroutine
    subroutine set_number(node, path, number) bind(c, name="catalyst_conduit_node_set_path_float64")
      import c_ptr, c_char, c_double
      type(c_ptr), value :: node
      character(kind=c_char), intent(in) :: path(*)
      real(c_double), value :: number
    end subroutine
    subroutine lend_numbers(node, path, values, count) bind(c, name="catalyst_conduit_node_set_path_external_float64_ptr")
      import c_ptr, c_char, c_int64_t
      type(c_ptr), value :: node
      character(kind=c_char), intent(in) :: path(*)
      type(c_ptr), value :: values
      integer(c_int64_t), value :: count
    end subroutine
    subroutine lend_integers(node, path, values, count) bind(c, name="catalyst_conduit_node_set_path_external_int32_ptr")
      import c_ptr, c_char, c_int64_t
      type(c_ptr), value :: node
      character(kind=c_char), intent(in) :: path(*)
      type(c_ptr), value :: values
      integer(c_int64_t), value :: count
    end subroutine
    function initialize(node) bind(c, name="catalyst_initialize")
      import c_ptr, c_int
      type(c_ptr), value :: node
      integer(c_int) :: initialize
    end function
    function execute(node) bind(c, name="catalyst_execute")
      import c_ptr, c_int
      type(c_ptr), value :: node
      integer(c_int) :: execute
    end function
    function finalize(node) bind(c, name="catalyst_finalize")
      import c_ptr, c_int
      type(c_ptr), value :: node
      integer(c_int) :: finalize
    end function
  end interface
end module

program heat
  use, intrinsic :: iso_c_binding
  use catalyst_functions
#ifdef HEAT_MPI
  use mpi
#endif
  implicit none

  integer, parameter :: side = 12, n = side + 1, steps = 20
  real(c_double), parameter :: width = 1.0d0/side
  character(kind=c_char), parameter :: nul = c_null_char
  ! Points of this process's layers along the axes, one array each, and temperatures, with a further layer on each side, which the
  ! neighbours hold: the order in which Fortran holds them is that of VTK.
  real(c_double), allocatable, target :: x(:, :, :), y(:, :, :), z(:, :, :), temperature(:, :, :)
  real(c_double), allocatable :: before(:, :, :)
  ! Numbers of points begin at 0.
  integer(c_int32_t), allocatable, target :: cells(:, :, :, :)
  type(c_ptr) :: node
  character(len=4096) :: folder, scene
  ! Processes, the first layer of this one (from 0), and its layers.
  integer :: rank = 0, processes = 1, first, layers
  integer :: i, j, k, step
#ifdef HEAT_MPI
  integer :: error
#endif

  if (command_argument_count() < 2) error stop "usage: heat FOLDER scene.toml"
  call get_command_argument(1, folder)
  call get_command_argument(2, scene)

#ifdef HEAT_MPI
  call MPI_Init(error)
  call MPI_Comm_rank(MPI_COMM_WORLD, rank, error)
  call MPI_Comm_size(MPI_COMM_WORLD, processes, error)
#endif
  first = side*rank/processes
  layers = side*(rank + 1)/processes - first + 1
  allocate (x(n, n, 0:layers + 1), y(n, n, 0:layers + 1), z(n, n, 0:layers + 1))
  allocate (temperature(n, n, 0:layers + 1), before(n, n, 0:layers + 1), cells(8, side, side, layers - 1))
  do k = 0, layers + 1
    do j = 1, n
      do i = 1, n
        x(i, j, k) = (i - 1)*width
        y(i, j, k) = (j - 1)*width
        z(i, j, k) = (first + k - 1)*width
      end do
    end do
  end do
  temperature = exp(-20.0d0*((x - 0.3d0)**2 + (y - 0.4d0)**2 + (z - 0.5d0)**2))
  do k = 1, layers - 1
    do j = 1, side
      do i = 1, side
        cells(:, i, j, k) = int([point(i, j, k), point(i + 1, j, k), point(i + 1, j + 1, k), point(i, j + 1, k), &
          point(i, j, k + 1), point(i + 1, j, k + 1), point(i + 1, j + 1, k + 1), point(i, j + 1, k + 1)], c_int32_t)
      end do
    end do
  end do

  node = create()
  call set_text(node, "catalyst_load/implementation"//nul, "voltet"//nul)
  call set_text(node, "catalyst_load/search_paths/voltet"//nul, trim(folder)//nul)
  call set_text(node, "catalyst/scripts/picture"//nul, trim(scene)//nul)
#ifdef HEAT_MPI
  ! The communicator is in Fortran the number that Catalyst takes.
  call set_integer(node, "catalyst/mpi_comm"//nul, int(MPI_COMM_WORLD, c_int64_t))
#endif
  call need(initialize(node), "catalyst_initialize")
  call destroy(node)

  do step = 0, steps, 10
    call draw(step)
    do i = 1, 10
      call advance()
      call exchange()
    end do
  end do

  node = create()
  call need(finalize(node), "catalyst_finalize")
  call destroy(node)
#ifdef HEAT_MPI
  call MPI_Finalize(error)
#endif

contains

  pure integer function point(i, j, k)
    integer, intent(in) :: i, j, k
    point = (i - 1) + n*((j - 1) + n*(k - 1))
  end function

  ! One explicit step; the faces of the box keep their temperature.
  subroutine advance()
    integer :: low, high
    low = merge(2, 1, first == 0)
    high = merge(layers - 1, layers, first + layers == n)
    before = temperature
    temperature(2:side, 2:side, low:high) = before(2:side, 2:side, low:high) + 0.1d0*( &
      before(3:n, 2:side, low:high) + before(1:side - 1, 2:side, low:high) + before(2:side, 3:n, low:high) + &
      before(2:side, 1:side - 1, low:high) + before(2:side, 2:side, low + 1:high + 1) + &
      before(2:side, 2:side, low - 1:high - 1) - 6.0d0*before(2:side, 2:side, low:high))
  end subroutine

  ! Takes the layers beside the slab from the neighbours.
  subroutine exchange()
#ifdef HEAT_MPI
    integer :: below, above
    below = merge(rank - 1, MPI_PROC_NULL, rank > 0)
    above = merge(rank + 1, MPI_PROC_NULL, rank + 1 < processes)
    ! The layer that both sides of a border hold is not sent.
    call MPI_Sendrecv(temperature(:, :, 2), n*n, MPI_DOUBLE_PRECISION, below, 0, &
      temperature(:, :, layers + 1), n*n, MPI_DOUBLE_PRECISION, above, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE, error)
    call MPI_Sendrecv(temperature(:, :, layers - 1), n*n, MPI_DOUBLE_PRECISION, above, 1, &
      temperature(:, :, 0), n*n, MPI_DOUBLE_PRECISION, below, 1, MPI_COMM_WORLD, MPI_STATUS_IGNORE, error)
#endif
  end subroutine

  ! Hands the mesh to Catalyst as Conduit's Mesh Blueprint describes it; arrays stay where they are.
  subroutine draw(step)
    integer, intent(in) :: step
    type(c_ptr) :: now, mesh
    integer(c_int64_t) :: count
    count = int(n*n*layers, c_int64_t)
    now = create()
    call set_integer(now, "catalyst/state/timestep"//nul, int(step, c_int64_t))
    call set_number(now, "catalyst/state/time"//nul, 0.1d0*step*width**2)
    call set_text(now, "catalyst/channels/grid/type"//nul, "mesh"//nul)
    mesh = fetch(now, "catalyst/channels/grid/data"//nul)
    call set_text(mesh, "coordsets/coords/type"//nul, "explicit"//nul)
    call lend_numbers(mesh, "coordsets/coords/values/x"//nul, c_loc(x(1, 1, 1)), count)
    call lend_numbers(mesh, "coordsets/coords/values/y"//nul, c_loc(y(1, 1, 1)), count)
    call lend_numbers(mesh, "coordsets/coords/values/z"//nul, c_loc(z(1, 1, 1)), count)
    call set_text(mesh, "topologies/mesh/type"//nul, "unstructured"//nul)
    call set_text(mesh, "topologies/mesh/coordset"//nul, "coords"//nul)
    call set_text(mesh, "topologies/mesh/elements/shape"//nul, "hex"//nul)
    call lend_integers(mesh, "topologies/mesh/elements/connectivity"//nul, c_loc(cells), size(cells, kind=c_int64_t))
    call set_text(mesh, "fields/T/association"//nul, "vertex"//nul)
    call set_text(mesh, "fields/T/topology"//nul, "mesh"//nul)
    call lend_numbers(mesh, "fields/T/values"//nul, c_loc(temperature(1, 1, 1)), count)
    call need(execute(now), "catalyst_execute")
    call destroy(now)
  end subroutine

  ! Ends the program where a call of Catalyst failed; the implementation has said why.
  subroutine need(status, what)
    integer(c_int), intent(in) :: status
    character(len=*), intent(in) :: what
    if (status /= 0) error stop what//" failed"
  end subroutine
end program
