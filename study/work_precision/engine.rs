//! The engines that a study draws with, and which of them are asked for.

use voltet_nodes::drawing;

/// What draws a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// Native code on all cores.
    Cpu,
    /// The device engine.
    Gpu {
        /// How pixels are composited, as the pipeline file calls it.
        compositor: &'static str,
    },
}

/// Which engines are studied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Engines {
    /// The native engine alone.
    Cpu,
    /// The device alone.
    Gpu,
    /// The native engine, and the device where there is one.
    #[default]
    All,
}

impl Engine {
    /// The device engine with each of its compositors.
    pub fn of_device() -> impl Iterator<Item = Engine> {
        drawing::compositors().map(|compositor| Engine::Gpu { compositor })
    }

    /// Its name in pipeline files.
    pub fn name(self) -> &'static str {
        match self {
            Engine::Cpu => "cpu",
            Engine::Gpu { .. } => "gpu",
        }
    }

    /// The compositor's name in pipeline files.
    pub fn compositor(self) -> Option<&'static str> {
        match self {
            Engine::Cpu => None,
            Engine::Gpu { compositor } => Some(compositor),
        }
    }

    /// Both, for people: "cpu", "gpu tiles".
    pub fn label(self) -> String {
        match self {
            Engine::Cpu => "cpu".into(),
            Engine::Gpu { compositor } => format!("gpu {compositor}"),
        }
    }

    /// 0 for the native engine, then the compositors of the device in their order.
    pub fn number(self) -> usize {
        match self {
            Engine::Cpu => 0,
            Engine::Gpu { compositor } => {
                let place = drawing::compositors().position(|known| known == compositor);
                1 + place.unwrap_or_default()
            }
        }
    }
}

impl Engines {
    /// Whether the native engine is among them.
    pub fn cpu(self) -> bool {
        self != Engines::Gpu
    }

    /// Whether the device is.
    pub fn gpu(self) -> bool {
        self != Engines::Cpu
    }
}
