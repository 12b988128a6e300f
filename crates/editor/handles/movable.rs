//! Objects in the picture that grips move.

use voltet_document::Edit;

/// An object in the picture that grips move. Places are in heights of the picture from its middle, to the right and up.
pub(super) trait Movable {
    /// Its kind and its node, "plane of clip"; the node alone of what has no kinds.
    fn name(&self) -> &str {
        self.node()
    }

    /// The node whose parameters it is.
    fn node(&self) -> &str;

    /// Lines that show where it is.
    fn lines(&self) -> Vec<[[f64; 2]; 2]> {
        Vec::new()
    }

    /// Names and places of its grips; no place behind the eye.
    fn places(&self) -> Vec<(String, Option<[f64; 2]>)>;

    /// Its grips that are before the eye.
    fn grips(&self) -> Vec<PictureGrip> {
        let grip = |(number, (name, place))| Some(PictureGrip { number, name, place: place? });
        self.places().into_iter().enumerate().filter_map(grip).collect()
    }

    /// The parameters when a grip is brought to a place.
    fn moved(&self, grip: usize, to: [f64; 2]) -> Vec<Edit>;

    /// The parameters when a key moves a grip: steps to the right and up, or forward.
    fn nudged(&self, grip: usize, by: [f64; 2]) -> Vec<Edit>;
}

#[derive(Clone)]
pub(super) struct PictureGrip {
    /// Number among the grips of its object.
    pub number: usize,
    pub name: String,
    pub place: [f64; 2],
}
