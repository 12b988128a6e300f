//! Engine that draws, and the compositor of one that has several.

use voltet_nodes::drawing::{ENGINES, NATIVE};
use voltet_optics::engine::{Compositor, EngineInfo};
use voltet_optics::shading::Ordering;

/// Engine and, if it has several, its compositor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RendererVariant {
    pub engine: &'static EngineInfo,
    /// Its compositor; `None` if it has one only.
    pub compositing: Option<Compositor>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Engines {
    /// This one alone.
    One(&'static EngineInfo),
    #[default]
    All,
}

impl RendererVariant {
    pub const NATIVE: RendererVariant = RendererVariant { engine: NATIVE, compositing: None };

    pub fn all_of_engine(engine: &'static EngineInfo) -> impl Iterator<Item = RendererVariant> {
        let only = engine.compositing.is_empty().then_some(None);
        let ways = only.into_iter().chain(engine.compositing.iter().copied().map(Some));
        ways.map(move |compositing| RendererVariant { engine, compositing })
    }

    pub fn all() -> impl Iterator<Item = RendererVariant> {
        ENGINES.iter().flat_map(RendererVariant::all_of_engine)
    }

    /// True if it makes such an order.
    pub fn makes(self, ordering: Ordering) -> bool {
        self.compositing.is_none_or(|compositor| compositor.makes(ordering))
    }

    /// The compositor's name in pipeline files.
    pub fn compositor(self) -> Option<&'static str> {
        self.compositing.map(Compositor::name)
    }

    /// Both names, for people: "cpu", "gpu tiles".
    pub fn label(self) -> String {
        match self.compositor() {
            None => self.engine.name.into(),
            Some(compositor) => format!("{} {compositor}", self.engine.name),
        }
    }

    /// Its place among all.
    pub fn number(self) -> usize {
        RendererVariant::all().position(|known| known == self).unwrap_or_default()
    }
}

impl Engines {
    pub fn each(self) -> impl Iterator<Item = &'static EngineInfo> {
        ENGINES.iter().filter(move |engine| match self {
            Engines::One(only) => *engine == only,
            Engines::All => true,
        })
    }
}
