//! Subjects of judgement: segment evaluators and engines.

use crate::devices;
use std::sync::Arc;
use voltet_core::Result;
use voltet_introspect::MeasuredEngine;
use voltet_judge::Evaluator64;
use voltet_judge::SegmentEvaluator;
use voltet_nodes::drawing::ENGINES;
use voltet_optics::engine::{Compositor, Engine, EngineInfo};

/// The sets of forms and the engines that this build and this machine have.
pub struct Subjects {
    /// The 64-bit ones, then those of every engine that has any.
    pub forms: Vec<Box<dyn SegmentEvaluator>>,
    /// Engines that are not judged, with the reason and the remedy.
    pub left_out: Vec<String>,
    pub(super) renderers: Vec<OpenRenderer>,
}

/// Engine that is open.
pub(super) struct OpenRenderer {
    pub declared: &'static EngineInfo,
    pub engine: Arc<dyn Engine>,
}

impl OpenRenderer {
    /// Its ways of compositing; the one that it has, where it has no choice.
    pub fn ways(&self) -> Vec<Option<Compositor>> {
        match self.declared.compositing {
            [] => vec![None],
            several => several.iter().copied().map(Some).collect(),
        }
    }
}

/// Everything that can be judged here. `adapter`: a device by its kind or a part of its name; without it the fastest that is
/// hardware, and what is left out where there is none.
///
/// Errors: a device that is named and not there.
pub fn subjects(adapter: Option<&str>) -> Result<Subjects> {
    let mut subjects =
        Subjects { forms: vec![Box::new(Evaluator64)], left_out: Vec::new(), renderers: Vec::new() };
    for declared in ENGINES {
        match devices::open_variants_of(declared, adapter.filter(|_| declared.on_device)) {
            Ok(each) => {
                subjects.forms.extend(each.iter().filter_map(|engine| engine.evaluator()));
                subjects.renderers.extend(each.into_iter().map(|engine| OpenRenderer { declared, engine }));
            }
            Err(error) if adapter.is_some() => return Err(error),
            Err(error) => subjects.left_out.push(format!("the engine {}: {error}", declared.name)),
        }
    }
    Ok(subjects)
}
