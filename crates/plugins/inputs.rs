//! Inputs of a call, compared whole with what they were before it. The interface hands them over as constant: a library that writes into
//! them changes data of the program, which are put back.

use crate::host::State;
use bytemuck::NoUninit;
use rayon::prelude::*;
use voltet_core::hash_of_bytes;

/// Bytes that are compared or hashed at a time.
const BLOCK: usize = 1 << 20;

#[derive(Default)]
pub(crate) struct Inputs(Vec<Input>);

struct Input {
    name: &'static str,
    /// Address of the first byte; no reference, since the plug-in may write there.
    address: *mut u8,
    byte_count: usize,
    element_bytes: usize,
    before: Before,
}

/// State of an input before the call.
enum Before {
    Copy(Vec<u8>),
    /// Hash of each block.
    Hashes(Vec<u64>),
}

impl Inputs {
    /// Adds an input that outlives the call, such as a grid that other nodes read: a change of it is undone. It must stay where it is until
    /// [`Inputs::refuse_changes`].
    pub fn add<T: NoUninit>(&mut self, name: &'static str, elements: &[T]) {
        self.insert(name, elements, |bytes| Before::Copy(copy(bytes)));
    }

    /// Adds an input that goes with the call. It must stay where it is until [`Inputs::refuse_changes`].
    pub fn add_own<T: NoUninit>(&mut self, name: &'static str, elements: &[T]) {
        match size_of_val(elements) {
            // Small enough to find the element.
            0..=BLOCK => self.add(name, elements),
            _ => self.insert(name, elements, |bytes| Before::Hashes(hashes(bytes))),
        }
    }

    fn insert<T: NoUninit>(
        &mut self,
        name: &'static str,
        elements: &[T],
        before: impl FnOnce(&[u8]) -> Before,
    ) {
        self.0.push(Input {
            name,
            address: elements.as_ptr().cast_mut().cast(),
            byte_count: size_of_val(elements),
            element_bytes: size_of::<T>(),
            before: before(bytemuck::cast_slice(elements)),
        });
    }

    /// Makes the call fail if one of its inputs has changed, and puts back what outlives it.
    pub fn refuse_changes(&self, state: &State) {
        for input in &self.0 {
            if let Some(place) = input.first_change() {
                let (name, count) = (input.name, input.byte_count / input.element_bytes);
                state.refuse(format!(
                    "it wrote into {name}, which it must leave as they are ({place} of {count})"
                ));
                input.restore();
            }
        }
    }
}

impl Input {
    fn now(&self) -> &[u8] {
        // SAFETY: the input is still there, which `Inputs::add` requires; no function of the plug-in runs now.
        unsafe { std::slice::from_raw_parts(self.address, self.byte_count) }
    }

    /// The first element that has changed, or the first block of them: "element 7", "element 131072 or one of the 131071 after it".
    fn first_change(&self) -> Option<String> {
        let now = self.now().par_chunks(BLOCK).enumerate();
        match &self.before {
            Before::Copy(before) => {
                let (block, bytes) =
                    now.find_first(|(i, bytes)| before[i * BLOCK..][..bytes.len()] != **bytes)?;
                let differs = |(now, before): (&u8, &u8)| now != before;
                let offset = bytes.iter().zip(&before[block * BLOCK..]).position(differs)?;
                Some(format!("element {}", (block * BLOCK + offset) / self.element_bytes))
            }
            Before::Hashes(before) => {
                let (block, bytes) = now.find_first(|(i, bytes)| before[*i] != hash_of_bytes(bytes))?;
                let (first, rest) = (block * BLOCK / self.element_bytes, bytes.len() / self.element_bytes);
                Some(format!("element {first} or one of the {rest} after it"))
            }
        }
    }

    /// Puts the bytes back.
    fn restore(&self) {
        if let Before::Copy(before) = &self.before {
            // SAFETY: as in `now`, and the plug-in has written there: the memory can be written to. Whoever reads it meanwhile reads what
            // the plug-in wrote, or what is right.
            unsafe { std::ptr::copy_nonoverlapping(before.as_ptr(), self.address, self.byte_count) };
        }
    }
}

/// A copy made by all threads: fresh memory costs more than what is written to it.
fn copy(bytes: &[u8]) -> Vec<u8> {
    match bytes.len() {
        0..=BLOCK => bytes.to_vec(),
        _ => bytes.par_iter().with_min_len(BLOCK).copied().collect(),
    }
}

fn hashes(bytes: &[u8]) -> Vec<u64> {
    bytes.par_chunks(BLOCK).map(hash_of_bytes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The refusal after `change` was done to numbers that outlive the call or go with it, and the numbers after that.
    fn refusal(count: usize, own: bool, change: impl FnOnce(&mut [u64])) -> (Option<String>, Vec<u64>) {
        let mut numbers: Vec<u64> = (0..count as u64).collect();
        let (mut inputs, state) = (Inputs::default(), State::default());
        match own {
            true => inputs.add_own("the numbers", &numbers),
            false => inputs.add("the numbers", &numbers),
        }
        change(&mut numbers);
        inputs.refuse_changes(&state);
        let refusal = state.reports().refusal.clone();
        (refusal, numbers)
    }

    #[test]
    fn a_change_of_one_element_is_found_and_undone() {
        for (count, at) in [(1, 0), (2, 1), (1000, 537), (400_000, 131_072), (400_003, 400_002), (400_003, 7)]
        {
            let (found, after) = refusal(count, false, |numbers| numbers[at] ^= 1 << 63);
            let said = format!("into the numbers, which it must leave as they are (element {at} of {count})");
            assert!(found.unwrap().contains(&said), "{said}");
            assert!(after.into_iter().eq(0..count as u64), "put back");
        }
    }

    #[test]
    fn a_change_of_one_element_is_found_in_large_inputs_of_the_call() {
        let block = BLOCK / 8;
        for (count, at) in [(1000, 537), (3 * block + 5, 2 * block + 1), (3 * block + 5, 3 * block + 4)] {
            let found = refusal(count, true, |numbers| numbers[at] ^= 1).0.unwrap();
            let first = if count > block { at / block * block } else { at };
            assert!(found.contains(&format!("(element {first} ")), "{found}");
        }
    }

    #[test]
    fn what_nobody_changed_is_not_refused() {
        for (count, own) in
            [0, 1, 1000, 400_000].into_iter().flat_map(|count| [(count, true), (count, false)])
        {
            assert_eq!(refusal(count, own, |_| ()).0, None);
        }
    }
}
