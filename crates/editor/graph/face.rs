//! Contents of a node besides its ports: its state, its time, its error, its picture.

use crate::theme;
use crate::worker::NodeState;
use eframe::egui::{Color32, TextureId};

/// Contents of a node besides its ports.
#[derive(Debug, Clone, Default)]
pub(super) struct Face {
    pub name: String,
    pub node_type: String,
    pub summary: String,
    pub state: Option<NodeState>,
    pub seconds: Option<f64>,
    /// Reason why the picture does not need it.
    pub idle: Option<String>,
    pub fault: Option<String>,
    pub picture: Option<(TextureId, f32)>,
    pub is_folded: bool,
    pub remark: Option<String>,
}

impl Face {
    /// The ground of the title: by the state.
    pub fn title_color(&self, dark: bool) -> Color32 {
        let of = |on_dark: [u8; 3], on_light: [u8; 3]| {
            let [r, g, b] = if dark { on_dark } else { on_light };
            Color32::from_rgb(r, g, b)
        };
        match (&self.fault, &self.state) {
            (Some(_), _) | (None, Some(NodeState::Failed(_))) => of([120, 40, 36], [240, 180, 175]),
            (None, Some(NodeState::Running(..))) => of([40, 84, 130], [175, 208, 240]),
            (None, Some(NodeState::Fresh | NodeState::Stale)) => of([72; 3], [205; 3]),
            (None, None) => of([52; 3], [220; 3]),
        }
    }

    /// Mark at the right of the title.
    pub fn mark(&self, dark: bool) -> (String, Color32) {
        let weak = theme::weak(dark);
        match (&self.fault, &self.state) {
            (Some(_), _) | (None, Some(NodeState::Failed(_))) => ("✖".into(), theme::wrong(dark)),
            (None, Some(NodeState::Running(_, fraction))) if *fraction > 0.0 => {
                (format!("{:.0} %", 100.0 * fraction), theme::accent(dark))
            }
            (None, Some(NodeState::Running(..))) => ("…".into(), theme::accent(dark)),
            (None, Some(NodeState::Stale)) => ("stale".into(), weak),
            (None, Some(NodeState::Fresh)) => {
                (self.seconds.map_or(String::new(), crate::picture::milliseconds), weak)
            }
            (None, None) => ("–".into(), weak),
        }
    }

    /// Everything about it, for whoever points at it.
    pub fn description(&self) -> String {
        let state = match (&self.state, &self.idle) {
            (Some(NodeState::Fresh), _) => match self.seconds {
                Some(seconds) => format!("done; took {}", crate::picture::milliseconds(seconds)),
                None => "done".into(),
            },
            (Some(NodeState::Stale), _) => "stale: will be made again".into(),
            (Some(NodeState::Running(stage, fraction)), _) => format!("{stage} {:.0} %", 100.0 * fraction),
            (Some(NodeState::Failed(error)), _) => error.clone(),
            (None, Some(idle)) => format!("not needed: {idle}"),
            (None, None) => String::new(),
        };
        // The same mistake may be known in other words: what it is stands before the colon.
        let what = |text: &str| text.split(':').next().map(str::to_string);
        let fault = self.fault.as_ref().filter(|fault| what(&state) != what(fault));
        let lines = [
            Some(format!("{} ({})", self.name, self.node_type)),
            Some(self.summary.clone()),
            Some(state),
            fault.cloned(),
        ];
        lines.into_iter().flatten().filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
    }
}
