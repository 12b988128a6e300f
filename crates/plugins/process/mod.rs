//! Plug-ins in a process of their own: a crash ends that, and not the program.
//!
//! The program starts itself again for each piece of work (`voltet plugin-process PATH`, which help does not list), hands over what
//! the filter is given through a pipe, and hears progress, what the filter says, and the gradient through another. To stop it ends the
//! process. The process loads and calls the library as the program would.
//!
//! | file | what |
//! | --- | --- |
//! | `wire` | bytes |
//! | `messages` | what is asked and answered |
//! | `declarations` | what plug-ins declare, in messages |
//! | `tasks`, `outcomes` | what is given, and what was made, in messages |
//! | `child` | the process |
//! | `conversation` | one piece of work, as the program sees it |
//! | `remote` | what runs a plug-in's functions that way |

mod child;
mod conversation;
mod declarations;
mod messages;
mod outcomes;
mod remote;
mod tasks;
pub(crate) mod wire;

pub use child::serve;
pub(crate) use remote::load;
