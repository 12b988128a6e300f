//! Inputs of a call, compared with samples from before it. The interface hands them over as constant: a library that writes into
//! them changes data of the program.

use crate::host::State;
use bytemuck::NoUninit;

/// Largest number of elements of an input that are compared. An input of more is compared at this many, evenly spread from the
/// first to the last: 1 to 2 MiB and a few milliseconds.
const MAX_SAMPLES: usize = 1 << 16;

/// Inputs of one call.
#[derive(Default)]
pub(crate) struct Inputs(Vec<Input>);

struct Input {
    name: &'static str,
    /// Address of the first element; no reference, since the plug-in may write there.
    address: *const u8,
    element_count: usize,
    element_bytes: usize,
    /// Bytes of the sampled elements before the call.
    samples: Vec<u8>,
}

impl Inputs {
    /// Adds an input, which must stay where it is until [`Inputs::refuse_changes`].
    pub fn add<T: NoUninit>(&mut self, name: &'static str, elements: &[T]) {
        let mut input = Input {
            name,
            address: elements.as_ptr().cast(),
            element_count: elements.len(),
            element_bytes: size_of::<T>(),
            samples: Vec::new(),
        };
        input.samples = input.sampled().flat_map(|i| input.element(i)).copied().collect();
        self.0.push(input);
    }

    /// Makes the call fail if one of its inputs has changed.
    pub fn refuse_changes(&self, state: &State) {
        for input in &self.0 {
            let before = input.samples.chunks_exact(input.element_bytes);
            if let Some((i, _)) = input.sampled().zip(before).find(|(i, before)| input.element(*i) != *before)
            {
                let Input { name, element_count, .. } = input;
                state.refuse(format!(
                    "it wrote into {name}, which it must leave as they are (element {i} of {element_count})"
                ));
            }
        }
    }
}

impl Input {
    /// Indices of the compared elements, ascending.
    fn sampled(&self) -> impl Iterator<Item = usize> + use<> {
        let (count, samples) = (self.element_count, self.element_count.min(MAX_SAMPLES));
        let index = move |i: usize| i as u128 * (count as u128 - 1) / (samples as u128 - 1).max(1);
        (0..samples).map(move |i| index(i) as usize)
    }

    /// Bytes of an element as they are now.
    fn element(&self, i: usize) -> &[u8] {
        // SAFETY: `i` is below the count, and the input is still there, which `Inputs::add` requires; no function of the plug-in
        // runs now.
        unsafe { std::slice::from_raw_parts(self.address.add(i * self.element_bytes), self.element_bytes) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The refusal after `change` was done to an input of `count` numbers.
    fn refusal(count: usize, change: impl FnOnce(&mut [u64])) -> Option<String> {
        let mut numbers: Vec<u64> = (0..count as u64).collect();
        let (mut inputs, state) = (Inputs::default(), State::default());
        inputs.add("the numbers", &numbers);
        change(&mut numbers);
        inputs.refuse_changes(&state);
        state.reports().refusal.clone()
    }

    #[test]
    fn a_change_of_one_element_is_found_in_inputs_up_to_the_limit() {
        for (count, at) in [(1, 0), (2, 1), (1000, 537), (MAX_SAMPLES, 40_001)] {
            let found = refusal(count, |numbers| numbers[at] += 1 << 63).unwrap();
            assert!(found.contains(&format!(
                "into the numbers, which it must leave as they are (element {at} of {count})"
            )));
        }
        for count in [0, 1, 1000, 3 * MAX_SAMPLES] {
            assert_eq!(refusal(count, |_| ()), None);
        }
    }

    #[test]
    fn larger_inputs_are_compared_at_both_ends_and_evenly_between() {
        let count = 5 * MAX_SAMPLES + 3;
        assert!(refusal(count, |numbers| numbers[0] = 7).is_some());
        assert!(refusal(count, |numbers| numbers[count - 1] = 7).is_some());
        assert!(refusal(count, |numbers| numbers[1000..1006].fill(7)).is_some());
        assert!(refusal(count, |numbers| numbers[1] = 7).is_none());
    }
}
