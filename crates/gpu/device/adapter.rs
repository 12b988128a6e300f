//! Adapters: enumeration and choice.

use voltet_core::{Error, Result};
use wgpu::DeviceType;

/// Kinds of adapters that a pipeline may name, the fastest first.
pub const KINDS: [(&str, DeviceType); 4] = [
    ("discrete", DeviceType::DiscreteGpu),
    ("integrated", DeviceType::IntegratedGpu),
    ("virtual", DeviceType::VirtualGpu),
    ("software", DeviceType::Cpu),
];

/// The adapters of this machine.
pub struct Adapters {
    found: Vec<wgpu::Adapter>,
}

/// The kind's name and its place among [`KINDS`].
pub(crate) fn kind(device_type: DeviceType) -> (usize, &'static str) {
    let found = KINDS.iter().position(|(_, kind)| *kind == device_type);
    found.map_or((KINDS.len(), "other"), |place| (place, KINDS[place].0))
}

/// Name and kind, for people.
pub(crate) fn describe(info: &wgpu::AdapterInfo) -> String {
    format!("{} ({}, {})", info.name, kind(info.device_type).1, info.backend)
}

impl Adapters {
    /// Looks for them.
    pub fn find() -> Adapters {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let mut found = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        found.sort_by_key(|adapter| kind(adapter.get_info().device_type).0);
        Adapters { found }
    }

    /// Each in words.
    pub fn described(&self) -> Vec<String> {
        self.found.iter().map(|adapter| describe(&adapter.get_info())).collect()
    }

    fn listed(&self) -> String {
        if self.found.is_empty() { "no adapter".to_string() } else { self.described().join(", ") }
    }

    /// The fastest, or the one that `wish` names: a kind, or a part of the name. With `hardware`, software devices are
    /// passed over unless they are wished for. Gives the adapter and why it is taken; an error says what there is.
    pub(crate) fn choose(&self, wish: Option<&str>, hardware: bool) -> Result<(&wgpu::Adapter, String)> {
        let Some(wish) = wish else {
            let fast =
                |adapter: &&wgpu::Adapter| !hardware || adapter.get_info().device_type != DeviceType::Cpu;
            return match self.found.iter().find(fast) {
                Some(adapter) => Ok((adapter, format!("{} is the fastest kind here", kind_of(adapter)))),
                None => Err(Error::run("there is no hardware adapter")
                    .got(self.listed())
                    .expected("a graphics device with a Vulkan, Metal or DirectX 12 driver")),
            };
        };
        let lower = wish.to_lowercase();
        let by_kind = self.found.iter().find(|adapter| kind_of(adapter) == lower);
        let by_name = || self.found.iter().find(|a| a.get_info().name.to_lowercase().contains(&lower));
        match by_kind.or_else(by_name) {
            Some(adapter) => Ok((adapter, format!("the pipeline asks for \"{wish}\""))),
            None => Err(Error::run(format!("no adapter is called \"{wish}\""))
                .got(self.listed())
                .expected("a part of a name, or \"discrete\", \"integrated\", \"virtual\", \"software\"")),
        }
    }
}

fn kind_of(adapter: &wgpu::Adapter) -> &'static str {
    kind(adapter.get_info().device_type).1
}
