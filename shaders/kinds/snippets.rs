//! Functions that the generated block calls for a widget.

/// A call of WGSL: the pieces that it takes, and its text. `#` stands for the widget's number, `part_#` for its part of the
/// segment, `depth_#` for its depth.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Snippet {
    pub pieces: Vec<&'static str>,
    pub text: String,
}

impl Snippet {
    pub(super) fn new(pieces: &[&'static str], text: impl Into<String>) -> Snippet {
        Snippet { pieces: pieces.to_vec(), text: text.into() }
    }
}

/// C of a widget that is alone on the segment.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Light {
    /// In closed form.
    Closed(Snippet),
    /// By the ordered integral.
    Integrated,
}

impl Light {
    /// c (1 − e^(−T)) of a widget with a colour, under the density-emitter.
    pub(super) fn of_density() -> Light {
        Light::Closed(Snippet::new(&["widgets/density_light"], "density_light(#u, depth_#)"))
    }
}

/// Error bound of mixed widgets, which exists for a colour that does not vary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mixing {
    /// Under either model.
    Bounded,
    /// Under the density-emitter: under the other it glows in many windows.
    DensityOnly,
    /// Never.
    Unbounded,
}

/// Functions that the generated block calls for a widget of one kind.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WidgetSnippets {
    /// T of its part.
    pub depth: Snippet,
    /// C where it is alone, under the model that was asked for.
    pub light: Light,
    /// Makes its track, over the whole segment.
    pub track: Snippet,
    /// The type of the track.
    pub track_type: &'static str,
    /// The next break of `members.track_#` behind t.
    pub next_break: String,
    /// Light and rate of `members.member_#` with `members.track_#` at four places.
    pub member_light: Snippet,
    /// The t between which it glows under the constant-emitter; `None` for what breaks there itself.
    pub window: Option<Snippet>,
    /// The rate above which it glows under the constant-emitter.
    pub threshold: &'static str,
    /// Error bound of its mix with others.
    pub mixing: Mixing,
}

/// The rate at the cutoff, for a profile of peak 1.
pub(super) const CUTOFF_RATE: &str = "widget_rate(#u, part_#) * scene.cutoff";
/// Rate of a widget that emits within its window, whatever the rounding of the rate.
pub(super) const ANY_RATE: &str = "0.0";

/// Light of a member whose colour is the widget's, from its rates.
pub(super) fn light_of_rates(piece: &'static str, rates: &str) -> Snippet {
    let text =
        format!("member_light(members.member_#, scene.widgets[#].color, at, {rates}(members.track_#, at))");
    Snippet::new(&[piece], text)
}
