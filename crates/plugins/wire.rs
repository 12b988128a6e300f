//! Messages between the program and the process of a plug-in: values one after the other, in this machine's byte order.

use bytemuck::Zeroable;
use std::ffi::CString;
use std::io::{self, Read, Write};
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::glam::DVec3;

/// Numbers received at a time.
const CHUNK: usize = 1 << 22;

/// A value that messages can hold.
pub(crate) trait Wire: Sized {
    fn send(&self, to: &mut dyn Write) -> io::Result<()>;

    /// Errors: the message ends early, or is not as sent: the sender may have been damaged.
    fn receive(from: &mut dyn Read) -> io::Result<Self>;

    /// Sends several without their count.
    fn send_all(items: &[Self], to: &mut dyn Write) -> io::Result<()> {
        items.iter().try_for_each(|item| item.send(to))
    }

    /// Receives so many. A damaged message may have any count: memory is touched as values come.
    fn receive_all(from: &mut dyn Read, count: usize) -> io::Result<Vec<Self>> {
        (0..count).map(|_| Self::receive(from)).collect()
    }
}

/// Error of a message that does not follow the format.
pub(crate) fn garbled() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "a message is not as agreed")
}

/// Implements [`Wire`] for structs by their fields, and for enums by a number and the contents of each variant. A variant that is
/// not listed cannot be sent.
macro_rules! wire {
    (fields of $name:ty { $($field:ident),* }) => {
        impl $crate::wire::Wire for $name {
            fn send(&self, to: &mut dyn std::io::Write) -> std::io::Result<()> {
                $($crate::wire::Wire::send(&self.$field, to)?;)*
                Ok(())
            }

            fn receive(from: &mut dyn std::io::Read) -> std::io::Result<Self> {
                Ok(Self { $($field: $crate::wire::Wire::receive(from)?),* })
            }
        }
    };
    (variants of $name:ty { $($tag:literal = $variant:ident $(($($item:ident),*))? $({ $($field:ident),* })?),* }) => {
        impl $crate::wire::Wire for $name {
            fn send(&self, to: &mut dyn std::io::Write) -> std::io::Result<()> {
                match self {
                    $(Self::$variant $(($($item),*))? $({ $($field),* })? => {
                        <u8 as $crate::wire::Wire>::send(&$tag, to)?;
                        $($($crate::wire::Wire::send($item, to)?;)*)?
                        $($($crate::wire::Wire::send($field, to)?;)*)?
                    })*
                    #[allow(unreachable_patterns)]
                    _ => return Err($crate::wire::garbled()),
                }
                Ok(())
            }

            fn receive(from: &mut dyn std::io::Read) -> std::io::Result<Self> {
                Ok(match <u8 as $crate::wire::Wire>::receive(from)? {
                    $($tag => {
                        $($(let $item = $crate::wire::Wire::receive(from)?;)*)?
                        $($(let $field = $crate::wire::Wire::receive(from)?;)*)?
                        Self::$variant $(($($item),*))? $({ $($field),* })?
                    })*
                    _ => return Err($crate::wire::garbled()),
                })
            }
        }
    };
}
pub(crate) use wire;

macro_rules! numbers {
    ($($number:ty),*) => {$(
        impl Wire for $number {
            fn send(&self, to: &mut dyn Write) -> io::Result<()> {
                to.write_all(bytemuck::bytes_of(self))
            }

            fn receive(from: &mut dyn Read) -> io::Result<Self> {
                let mut number = Self::zeroed();
                from.read_exact(bytemuck::bytes_of_mut(&mut number))?;
                Ok(number)
            }

            fn send_all(items: &[Self], to: &mut dyn Write) -> io::Result<()> {
                to.write_all(bytemuck::cast_slice(items))
            }

            fn receive_all(from: &mut dyn Read, count: usize) -> io::Result<Vec<Self>> {
                let mut items = Vec::new();
                let none = |_| io::Error::new(io::ErrorKind::OutOfMemory, "there is no memory for an array");
                items.try_reserve_exact(count).map_err(none)?;
                while items.len() < count {
                    let begin = items.len();
                    items.resize(begin + (count - begin).min(CHUNK), Self::zeroed());
                    from.read_exact(bytemuck::cast_slice_mut(&mut items[begin..]))?;
                }
                Ok(items)
            }
        }
    )*};
}

numbers!(u8, i32, u32, i64, u64, usize, f64, DVec3, [u32; 4], [f32; 4]);

/// Implements [`Wire`] for types that are sent as another one: how it is made of the value, and the value of it.
macro_rules! sent_as {
    ($([$($generics:tt)*] $name:ty: $sent:ty, $to:expr, $from:expr;)*) => {$(
        impl<$($generics)*> Wire for $name {
            fn send(&self, to: &mut dyn Write) -> io::Result<()> {
                let items: &[$sent] = ($to)(self);
                items.len().send(to)?;
                <$sent>::send_all(items, to)
            }

            fn receive(from: &mut dyn Read) -> io::Result<Self> {
                let count = usize::receive(from)?;
                <$sent>::receive_all(from, count).and_then($from)
            }
        }
    )*};
}

// Of the declarations, whose texts and lists live as long as the program.
sent_as! {
    [T: Wire] Vec<T>: T, Vec::as_slice, Ok;
    [T: Wire] SharedSlice<T>: T, SharedSlice::as_slice, |items: Vec<T>| Ok(items.into());
    [T: Wire + 'static] &'static [T]: T, |items: &Self| *items, |items: Vec<T>| Ok(&*items.leak());
    [] &'static str: u8, |text: &Self| text.as_bytes(), |bytes| text(bytes).map(|text| &*text.leak());
    [] String: u8, String::as_bytes, text;
    [] CString: u8, CString::as_bytes, |bytes: Vec<u8>| CString::new(bytes).map_err(|_| garbled());
}

fn text(bytes: Vec<u8>) -> io::Result<String> {
    String::from_utf8(bytes).map_err(|_| garbled())
}

impl Wire for bool {
    fn send(&self, to: &mut dyn Write) -> io::Result<()> {
        u8::from(*self).send(to)
    }

    fn receive(from: &mut dyn Read) -> io::Result<Self> {
        match u8::receive(from)? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(garbled()),
        }
    }
}

impl<T: Wire> Wire for Option<T> {
    fn send(&self, to: &mut dyn Write) -> io::Result<()> {
        self.is_some().send(to)?;
        self.iter().try_for_each(|item| item.send(to))
    }

    fn receive(from: &mut dyn Read) -> io::Result<Self> {
        bool::receive(from)?.then(|| T::receive(from)).transpose()
    }
}

impl<T: Wire> Wire for Arc<T> {
    fn send(&self, to: &mut dyn Write) -> io::Result<()> {
        T::send(self, to)
    }

    fn receive(from: &mut dyn Read) -> io::Result<Self> {
        T::receive(from).map(Arc::new)
    }
}

impl<A: Wire, B: Wire> Wire for (A, B) {
    fn send(&self, to: &mut dyn Write) -> io::Result<()> {
        self.0.send(to)?;
        self.1.send(to)
    }

    fn receive(from: &mut dyn Read) -> io::Result<Self> {
        Ok((A::receive(from)?, B::receive(from)?))
    }
}
