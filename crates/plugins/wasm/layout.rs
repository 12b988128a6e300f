//! Layout of the header's structs in 32-bit WebAssembly: addresses have 4 bytes, numbers of 8 bytes stand at multiples of 8. A test
//! compares it with that of a compiler.

/// Size of a struct and offsets of its fields (bytes).
pub(super) mod entry {
    pub const SIZE: u32 = 28;
    pub const INIT: u32 = 16;
    pub const GET_FACTORY: u32 = 24;
}

pub(super) mod plugin {
    pub const SIZE: u32 = 16;
    pub const NAME: u32 = 8;
    pub const VERSION: u32 = 12;
}

pub(super) mod factory {
    pub const SIZE: u32 = 16;
    pub const FILTER_COUNT: u32 = 8;
    pub const FILTER: u32 = 12;
}

pub(super) mod filter {
    pub const SIZE: u32 = 36;
    pub const NEEDS: u32 = 4;
    pub const NAME: u32 = 8;
    pub const SUMMARY: u32 = 12;
    pub const PARAMETER_COUNT: u32 = 16;
    pub const PARAMETERS: u32 = 24;
    pub const CHECK: u32 = 28;
    pub const GRADIENT: u32 = 32;
}

pub(super) mod parameter {
    pub const SIZE: u32 = 88;
    pub const TYPE: u32 = 4;
    pub const NAME: u32 = 8;
    pub const UNIT: u32 = 12;
    pub const HELP: u32 = 16;
    pub const FLAGS: u32 = 20;
    pub const LENGTH: u32 = 24;
    pub const MIN: u32 = 32;
    pub const MAX: u32 = 40;
    pub const NUMBER: u32 = 48;
    pub const TEXT: u32 = 56;
    pub const NUMBERS: u32 = 60;
    pub const UNSET: u32 = 64;
    pub const WORD_COUNT: u32 = 68;
    pub const NAMES: u32 = 76;
    pub const MEANINGS: u32 = 80;
}
