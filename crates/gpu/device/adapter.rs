//! Adapters: enumeration, choice, and the cached absence of hardware ones.
//!
//! The probe for adapters loads every installed driver, which takes as long as a picture. That it found no hardware is remembered
//! for one boot of one machine, user and environment, device nodes and list of Vulkan drivers, on Linux, where all of these can be
//! seen without a driver. Adapters that are there are probed each time.

use voltet_core::{Error, Result};
use voltet_optics::engine::KeyValueStore;
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

    /// True if one of them is hardware.
    pub(crate) fn have_hardware(&self) -> bool {
        self.found.iter().any(is_hardware)
    }

    pub(crate) fn listed(&self) -> String {
        if self.found.is_empty() { "no adapter".to_string() } else { self.described().join(", ") }
    }

    /// The fastest, or the one that `wish` names: a kind, or a part of the name. With `hardware`, software devices are
    /// passed over unless they are wished for. Gives the adapter and why it is taken; an error says what there is.
    pub(crate) fn choose(&self, wish: Option<&str>, hardware: bool) -> Result<(&wgpu::Adapter, String)> {
        let Some(wish) = wish else {
            let fast = |adapter: &&wgpu::Adapter| !hardware || is_hardware(adapter);
            return match self.found.iter().find(fast) {
                Some(adapter) => Ok((adapter, format!("{} is the fastest kind here", kind_of(adapter)))),
                None => Err(no_hardware(&self.listed())),
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

/// The error in place of a device.
pub(crate) fn no_hardware(listed: &str) -> Error {
    let error = Error::run("there is no hardware adapter").got(listed);
    error.expected("a graphics device with a Vulkan, Metal or DirectX 12 driver")
}

fn kind_of(adapter: &wgpu::Adapter) -> &'static str {
    kind(adapter.get_info().device_type).1
}

fn is_hardware(adapter: &wgpu::Adapter) -> bool {
    adapter.get_info().device_type != DeviceType::Cpu
}

/// The adapters that are not hardware, in words, where they were all that there was when everything was as it is now.
pub(crate) fn recall(memory: &dyn KeyValueStore) -> Option<String> {
    recall_in(&surroundings()?, memory)
}

/// Keeps that there were these alone.
pub(crate) fn keep(memory: &dyn KeyValueStore, listed: &str) {
    if let Some(surroundings) = surroundings() {
        keep_in(&surroundings, memory, listed);
    }
}

/// Fingerprint of everything that the probe depends on: machine, drivers, environment.
struct SystemFingerprint {
    machine: String,
    everything: String,
}

impl SystemFingerprint {
    /// The number changes with what is looked at.
    fn key(&self) -> String {
        format!("voltet adapters 1\n{}\n", self.machine)
    }
}

/// Separator between the fingerprint and the adapters.
const FOUND: &str = "found ";

fn recall_in(surroundings: &SystemFingerprint, memory: &dyn KeyValueStore) -> Option<String> {
    let text = memory.recall(&surroundings.key())?;
    let listed = text.strip_prefix(&surroundings.everything)?.strip_prefix(FOUND)?.strip_suffix('\n')?;
    Some(listed.to_string())
}

fn keep_in(surroundings: &SystemFingerprint, memory: &dyn KeyValueStore, listed: &str) {
    let text = format!("{}{FOUND}{}\n", surroundings.everything, listed.replace('\n', " "));
    memory.keep(&surroundings.key(), &text);
}

#[cfg(not(target_os = "linux"))]
fn surroundings() -> Option<SystemFingerprint> {
    None
}

#[cfg(target_os = "linux")]
fn surroundings() -> Option<SystemFingerprint> {
    use std::fmt::Write;
    let kernel = |name: &str| std::fs::read_to_string(format!("/proc/sys/kernel/{name}")).ok();
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let machine = kernel("hostname")?.trim().to_string();
    let mut everything = format!("voltet {}, boot {}", env!("CARGO_PKG_VERSION"), kernel("random/boot_id")?);
    let is_who = |line: &&str| ["Uid:", "Gid:", "Groups:"].iter().any(|name| line.starts_with(name));
    status.lines().filter(is_who).for_each(|line| {
        let _ = writeln!(everything, "{line}");
    });
    for (name, value) in linux::variables() {
        let _ = writeln!(everything, "{name}={value}");
    }
    for folder in linux::folders() {
        everything += &linux::listed(&folder);
    }
    Some(SystemFingerprint { machine, everything })
}

#[cfg(target_os = "linux")]
mod linux {
    use std::os::unix::fs::{FileTypeExt, MetadataExt};
    use std::path::{Path, PathBuf};

    /// Variables that drivers and their loader look at, by the beginnings of their names.
    const VARIABLES: [&str; 23] = [
        "VK_",
        "VN_",
        "MESA_",
        "LIBGL_",
        "LP_",
        "GALLIUM_",
        "DRI_",
        "RADV_",
        "AMD",
        "ANV_",
        "INTEL_",
        "TU_",
        "NVK_",
        "NVIDIA_",
        "__NV",
        "__VK",
        "__GL",
        "CUDA_",
        "WGPU_",
        "DISPLAY",
        "WAYLAND_DISPLAY",
        "LD_LIBRARY_PATH",
        "NODEVICE_SELECT",
    ];

    /// The folders below which the loader of Vulkan finds drivers and layers, with what stands where no variable says.
    const BASES: [(&str, &str); 4] = [
        ("XDG_CONFIG_DIRS", "/etc/xdg"),
        ("XDG_DATA_DIRS", "/usr/local/share:/usr/share"),
        ("XDG_CONFIG_HOME", ""),
        ("XDG_DATA_HOME", ""),
    ];

    /// In the order of their names.
    pub fn variables() -> Vec<(String, String)> {
        let text = |value: std::ffi::OsString| value.to_string_lossy().into_owned();
        let all = std::env::vars_os().map(|(name, value)| (text(name), text(value)));
        let is_looked_at =
            |(name, _): &(String, String)| VARIABLES.iter().any(|begin| name.starts_with(begin));
        let mut found: Vec<_> = all.filter(is_looked_at).collect();
        found.sort();
        found
    }

    /// Folders of device nodes and of the manifests of drivers.
    pub fn folders() -> Vec<PathBuf> {
        let mut bases: Vec<PathBuf> = ["/etc", "/usr/local/etc"].map(PathBuf::from).into();
        if let Some(home) = std::env::var_os("HOME") {
            bases.extend([".config", ".local/share"].map(|name| Path::new(&home).join(name)));
        }
        for (variable, usual) in BASES {
            let value = std::env::var_os(variable).filter(|value| !value.is_empty());
            bases.extend(std::env::split_paths(&value.unwrap_or_else(|| usual.into())));
        }
        let mut folders: Vec<PathBuf> = ["/dev", "/dev/dri", "/dev/nvidia-caps"].map(PathBuf::from).into();
        for base in bases.iter().filter(|base| base.is_absolute()) {
            folders.extend(["icd.d", "implicit_layer.d"].map(|name| base.join("vulkan").join(name)));
        }
        folders
    }

    /// A line for each device node and file of a folder: whose it is, and its size and time. Terminals and loops come and go.
    pub fn listed(folder: &Path) -> String {
        let Ok(entries) = std::fs::read_dir(folder) else { return String::new() };
        let mut lines: Vec<String> = entries
            .filter_map(|entry| {
                let path = entry.ok()?.path();
                let name = path.file_name()?.to_str()?;
                let passing =
                    ["tty", "loop", "pt", "vcs", "std", "fd"].iter().any(|begin| name.starts_with(begin));
                let found = std::fs::metadata(&path).ok()?;
                let what = found.file_type();
                // What is written to a node changes its time.
                let state = if what.is_char_device() || what.is_block_device() {
                    found.rdev().to_string()
                } else if what.is_file() {
                    format!("{} {}.{:09}", found.size(), found.mtime(), found.mtime_nsec())
                } else {
                    return None;
                };
                let (mode, user, group) = (found.mode(), found.uid(), found.gid());
                (!passing).then(|| format!("{} {mode:o} {user} {group} {state}\n", path.display()))
            })
            .collect();
        lines.sort();
        lines.concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;
    use std::sync::Mutex;

    #[derive(Default)]
    struct Kept(Mutex<HashMap<String, String>>);

    impl KeyValueStore for Kept {
        fn recall(&self, key: &str) -> Option<String> {
            self.0.lock().unwrap().get(key).cloned()
        }

        fn keep(&self, key: &str, text: &str) {
            self.0.lock().unwrap().insert(key.into(), text.into());
        }
    }

    fn surrounded(machine: &str, everything: &str) -> SystemFingerprint {
        SystemFingerprint { machine: machine.into(), everything: everything.into() }
    }

    #[test]
    fn what_was_found_is_recalled_where_nothing_changed() {
        let memory = Kept::default();
        let here = surrounded("here", "boot 1\n/dev/null 20666 0 0 259\n");
        assert_eq!(recall_in(&here, &memory), None);
        keep_in(&here, &memory, "llvmpipe (software, vulkan)");
        assert_eq!(recall_in(&here, &memory).as_deref(), Some("llvmpipe (software, vulkan)"));
        for other in [
            "boot 2\n/dev/null 20666 0 0 259\n",
            "boot 1\n",
            "boot 1\n/dev/null 20666 0 0 259\n/dev/dxg\n",
            "",
        ] {
            assert_eq!(recall_in(&surrounded("here", other), &memory), None, "{other}");
        }
        assert_eq!(recall_in(&surrounded("there", &here.everything), &memory), None);
        // One file a machine: the next boot takes its place.
        keep_in(&surrounded("here", "boot 2\n"), &memory, "no adapter");
        assert_eq!(memory.0.lock().unwrap().len(), 1);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_is_told_by_its_files() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let seen = || linux::listed(folder.path());
        assert_eq!(seen(), "");
        let file = folder.path().join("a_driver.json");
        std::fs::write(&file, "{}").unwrap();
        let one = seen();
        assert!(one.contains("a_driver.json") && one == seen(), "{one}");
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o600)).unwrap();
        let closed = seen();
        std::fs::write(&file, "{ }").unwrap();
        let larger = seen();
        assert!(one != closed && closed != larger);
        std::fs::write(folder.path().join("tty7"), "").unwrap();
        assert_eq!(seen(), larger);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn nothing_changes_by_itself() {
        let [first, second] = [surroundings().unwrap(), surroundings().unwrap()];
        assert_eq!((first.machine, &first.everything), (second.machine, &second.everything));
        assert!(first.everything.contains("/dev/null"), "{}", first.everything);
    }
}
