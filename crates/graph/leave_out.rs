//! Leave to leave something out.

/// Leave to do less than everything that could be done. Who leaves something out needs it, and notes with it what and why
/// ([`Notes::leave_out`](super::Notes::leave_out)). A session of [`Session::no_leave_out`](super::Session::no_leave_out) gives
/// none: everything is done then, needed or not, and the outputs mean the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MayLeaveOut(());

impl MayLeaveOut {
    /// Where no session says otherwise: nobody compares.
    /// The leave itself.
    pub const GIVEN: MayLeaveOut = MayLeaveOut(());

    pub(super) fn unless(no_leave_out: bool) -> Option<MayLeaveOut> {
        (!no_leave_out).then_some(Self::GIVEN)
    }
}
