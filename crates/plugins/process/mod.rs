//! Plug-ins in a process of their own: a crash ends that, and not the program.
//!
//! The program starts itself again for each piece of work (`voltet plugin-process PATH`, which help does not list), sends the
//! inputs through a pipe, and receives progress, status and output through another. To cancel the work it ends the process. The
//! process loads and calls the library as the program would.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `messages` | requests and replies |
//! | `declarations` | declarations in messages |
//! | `child` | side of the process |
//! | `exchange` | side of the program |
//! | `remote` | the runner |

mod child;
mod declarations;
mod exchange;
mod messages;
mod remote;

pub use child::run_child;
pub(crate) use remote::load;
