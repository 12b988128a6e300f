//! Lane sets, and what runs a kernel on one.

#[cfg(target_arch = "x86_64")]
use super::avx2::Avx2;
#[cfg(target_arch = "x86_64")]
use super::avx512::Avx512;
use super::operations::Lanes;
use super::portable::Portable;

/// Work that can run on any lane set.
pub trait Kernel {
    /// What it returns.
    type Output;
    /// Runs on the lanes `L`. Mark the implementation `#[inline(always)]`.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// A lane set by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaneSet {
    /// 16 lanes: AVX-512 F, BW, DQ, VL.
    Avx512,
    /// 8 lanes: AVX2 and FMA (and the bit operations that came with them).
    Avx2,
    /// 4 lanes in plain Rust.
    Portable,
}

impl LaneSet {
    /// The widest set this processor has. `VOLTET_LANES` = `avx512`, `avx2` or `portable` narrows it (to compare
    /// the paths); a set that the processor lacks is never chosen.
    pub fn detect() -> LaneSet {
        static DETECTED: std::sync::OnceLock<LaneSet> = std::sync::OnceLock::new();
        *DETECTED.get_or_init(|| {
            let asked = std::env::var("VOLTET_LANES").unwrap_or_default();
            let at_most = match asked.as_str() {
                "portable" => return LaneSet::Portable,
                "avx2" => LaneSet::Avx2,
                _ => LaneSet::Avx512,
            };
            if at_most == LaneSet::Avx512 && LaneSet::Avx512.is_supported() {
                LaneSet::Avx512
            } else if LaneSet::Avx2.is_supported() {
                LaneSet::Avx2
            } else {
                LaneSet::Portable
            }
        })
    }

    /// Whether this processor has the set.
    pub fn is_supported(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        {
            match self {
                LaneSet::Avx512 => {
                    is_x86_feature_detected!("avx512f")
                        && is_x86_feature_detected!("avx512bw")
                        && is_x86_feature_detected!("avx512dq")
                        && is_x86_feature_detected!("avx512vl")
                        && LaneSet::Avx2.is_supported()
                }
                LaneSet::Avx2 => {
                    is_x86_feature_detected!("avx2")
                        && is_x86_feature_detected!("fma")
                        && is_x86_feature_detected!("popcnt")
                        && is_x86_feature_detected!("bmi1")
                        && is_x86_feature_detected!("bmi2")
                        && is_x86_feature_detected!("lzcnt")
                }
                LaneSet::Portable => true,
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self == LaneSet::Portable
        }
    }

    /// What [`dispatch`] runs when it is asked for this set: the portable one stands in for one that the processor lacks.
    fn or_portable(self) -> LaneSet {
        if self.is_supported() { self } else { LaneSet::Portable }
    }

    /// Lanes of 32-bit floats that a kernel has which is dispatched on this set.
    pub fn width(self) -> usize {
        match self.or_portable() {
            LaneSet::Avx512 => 16,
            LaneSet::Avx2 => 8,
            LaneSet::Portable => 4,
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

/// Runs a kernel on a lane set; one that the processor lacks is replaced by the portable set.
pub fn dispatch<K: Kernel>(lanes: LaneSet, kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
        fn avx512<K: Kernel>(kernel: K) -> K::Output {
            kernel.run::<Avx512>()
        }
        #[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
        fn avx2<K: Kernel>(kernel: K) -> K::Output {
            kernel.run::<Avx2>()
        }
        match lanes.or_portable() {
            // SAFETY: the features were just found on this processor.
            LaneSet::Avx512 => return unsafe { avx512(kernel) },
            // SAFETY: the features were just found on this processor.
            LaneSet::Avx2 => return unsafe { avx2(kernel) },
            LaneSet::Portable => {}
        }
    }
    let _ = lanes;
    kernel.run::<Portable>()
}
