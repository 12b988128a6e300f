//! Lane sets, and what runs a kernel on one.

#[cfg(target_arch = "x86_64")]
use super::avx2::Avx2;
#[cfg(target_arch = "x86_64")]
use super::avx512::Avx512;
use super::operations::Lanes;
use super::portable::Portable;
use std::sync::OnceLock;
use voltet_core::{Error, Result};

/// The environment variable that names a lane set.
const VARIABLE: &str = "VOLTET_LANES";

/// Work that can run on any lane set, with a result.
pub trait Kernel<R = ()> {
    /// Runs on the lanes `L`. Mark the implementation `#[inline(always)]`.
    fn run<L: Lanes>(self) -> R;
}

/// A lane set by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaneSet {
    /// 16 lanes: AVX-512 F, BW, DQ, VL.
    Avx512,
    /// 8 lanes: AVX2 and FMA (and the bit operations that came with them).
    Avx2,
    /// Lanes that every processor has: 4 of SSE2 on x86-64, 8 of NEON on AArch64, arrays of 4 elsewhere.
    Portable,
}

impl LaneSet {
    /// All of them, the widest first.
    pub const ALL: [LaneSet; 3] = [LaneSet::Avx512, LaneSet::Avx2, LaneSet::Portable];

    /// The set that the environment variable `VOLTET_LANES` names (to compare them), or the widest that this processor has.
    ///
    /// Errors: the variable names none, or one that this processor lacks.
    pub fn detect() -> Result<LaneSet> {
        static DETECTED: OnceLock<Result<LaneSet>> = OnceLock::new();
        let asked = || std::env::var_os(VARIABLE).map(|asked| asked.to_string_lossy().into_owned());
        DETECTED.get_or_init(|| LaneSet::asked(asked().as_deref(), LaneSet::is_supported)).clone()
    }

    /// The set that is asked for by name, or the widest of those that there are.
    fn asked(asked: Option<&str>, is_supported: fn(LaneSet) -> bool) -> Result<LaneSet> {
        let mut there = LaneSet::ALL.into_iter().filter(|set| is_supported(*set));
        let Some(asked) = asked.filter(|asked| !asked.is_empty()) else {
            return Ok(there.next().unwrap_or(LaneSet::Portable));
        };
        let names =
            |sets: &mut dyn Iterator<Item = LaneSet>| sets.map(LaneSet::name).collect::<Vec<_>>().join(", ");
        // What was a set of its own.
        let name = if asked == "neon" && cfg!(target_arch = "aarch64") { "portable" } else { asked };
        match LaneSet::ALL.into_iter().find(|set| set.name() == name) {
            Some(set) if is_supported(set) => Ok(set),
            Some(_) => {
                Err(Error::usage(format!("this processor lacks the vector units that {VARIABLE} names"))
                    .got(asked)
                    .expected(names(&mut there)))
            }
            None => Err(Error::usage(format!("{VARIABLE} names no set of vector lanes"))
                .got(asked)
                .expected(names(&mut LaneSet::ALL.into_iter()))),
        }
    }

    /// True if this processor has the set.
    pub fn is_supported(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            LaneSet::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
                    && LaneSet::Avx2.is_supported()
            }
            #[cfg(target_arch = "x86_64")]
            LaneSet::Avx2 => {
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("fma")
                    && is_x86_feature_detected!("popcnt")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2")
                    && is_x86_feature_detected!("lzcnt")
            }
            #[cfg(not(target_arch = "x86_64"))]
            LaneSet::Avx512 | LaneSet::Avx2 => false,
            LaneSet::Portable => true,
        }
    }

    /// Lane set that [`dispatch`] runs for this one: the portable set replaces one that the processor lacks.
    fn or_portable(self) -> LaneSet {
        if self.is_supported() { self } else { LaneSet::Portable }
    }

    /// Lanes of 32-bit floats that a kernel has which is dispatched on this set.
    pub fn width(self) -> usize {
        match self.or_portable() {
            LaneSet::Avx512 => 16,
            LaneSet::Avx2 => 8,
            LaneSet::Portable => Portable::WIDTH,
        }
    }

    /// The name as `VOLTET_LANES` takes it.
    pub fn name(self) -> &'static str {
        match self {
            LaneSet::Avx512 => "avx512",
            LaneSet::Avx2 => "avx2",
            LaneSet::Portable => "portable",
        }
    }
}

/// A place on the stack whose address is looked at: the whole frame is then aligned as this is, and vectors that a kernel
/// keeps there do not straddle cache lines.
#[cfg(target_arch = "x86_64")]
#[repr(align(64))]
struct CacheLine(#[expect(dead_code, reason = "it stands for its address")] u8);

/// Runs a kernel on a lane set; one that the processor lacks is replaced by the portable set.
pub fn dispatch<R, K: Kernel<R>>(lanes: LaneSet, kernel: K) -> R {
    match lanes.or_portable() {
        #[cfg(target_arch = "x86_64")]
        LaneSet::Avx512 => run::<Avx512, R, K>(kernel),
        #[cfg(target_arch = "x86_64")]
        LaneSet::Avx2 => run::<Avx2, R, K>(kernel),
        _ => run::<Portable, R, K>(kernel),
    }
}

/// Runs a kernel on lanes that the processor has.
fn run<L: Lanes, R, K: Kernel<R>>(kernel: K) -> R {
    let run = inlined!(|kernel: K| {
        #[cfg(target_arch = "x86_64")]
        std::hint::black_box(&mut CacheLine(0));
        kernel.run::<L>()
    });
    L::call(run, kernel)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_that_is_no_name_or_not_there_is_refused() {
        let narrow = |set: LaneSet| set != LaneSet::Avx512;
        assert_eq!(LaneSet::asked(None, narrow).unwrap(), LaneSet::Avx2);
        assert_eq!(LaneSet::asked(Some(""), |_| true).unwrap(), LaneSet::Avx512);
        for set in LaneSet::ALL {
            assert_eq!(LaneSet::asked(Some(set.name()), |_| true).unwrap(), set);
        }
        let of_arm = LaneSet::asked(Some("neon"), |_| true).ok();
        assert_eq!(of_arm, cfg!(target_arch = "aarch64").then_some(LaneSet::Portable));
        let said = |asked: &str| LaneSet::asked(Some(asked), narrow).unwrap_err().to_string();
        let unknown = said("AVX2");
        assert!(unknown.contains("VOLTET_LANES") && unknown.contains("AVX2"), "{unknown}");
        assert!(unknown.contains("avx512, avx2, portable"), "{unknown}");
        let lacking = said("avx512");
        assert!(lacking.contains("this processor lacks") && lacking.contains("VOLTET_LANES"), "{lacking}");
        assert!(lacking.contains("avx512") && lacking.contains("avx2, portable"), "{lacking}");
    }
}
