//! Plug-ins in a process of their own: a crash ends that, and not the program.
//!
//! The program starts itself again for each piece of work (`voltet plugin-process PATH`, which help does not list), sends the
//! inputs through a pipe, and receives progress, status and output through another. To cancel the work it ends the process. The
//! process loads and calls the library as the program would.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `messages` | requests and replies |
//! | `child` | side of the process |
//! | `remote` | side of the program |

mod child;
mod messages;
mod remote;

pub use child::run_child;
pub(crate) use remote::load;
