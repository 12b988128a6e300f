//! Coordinate sets to points. Coordinates that lie x, y, z, x, y, z, … in 64 bits are borrowed; others are copied.

use crate::conduit::{Loan, Node, Numbers};
use glam::DVec3;
use voltet_core::{Result, SharedSlice};

/// Axes of space, with the names of the counts along them.
const AXES: [(&str, &str); 3] = [("x", "i"), ("y", "j"), ("z", "k")];

pub(super) struct Coordinates<'a> {
    node: Node<'a>,
    kind: String,
}

impl<'a> Coordinates<'a> {
    /// The coordinate set that a topology names. Errors: no such set, or one of an unknown type.
    pub fn find(domain: &Node<'a>, topology: &Node<'a>) -> Result<Coordinates<'a>> {
        let name = topology.text_at("coordset")?;
        let node = domain.require(&format!("coordsets/{name}"))?;
        let kind = node.require("type")?;
        let text = kind.text()?;
        match text.as_str() {
            "uniform" | "rectilinear" | "explicit" => Ok(Coordinates { node, kind: text }),
            other => {
                Err(kind.wrong("is unknown", format!("\"{other}\""), "uniform, rectilinear or explicit"))
            }
        }
    }

    /// Number of dimensions of the space. Errors: coordinates that are not Cartesian.
    pub fn dimension(&self) -> Result<usize> {
        let (values, names) = match self.kind.as_str() {
            "uniform" => (self.node.require("dims")?, AXES.map(|axis| axis.1)),
            _ => (self.node.require("values")?, AXES.map(|axis| axis.0)),
        };
        let children = values.children();
        if let Some(other) = children.iter().find(|child| !names.contains(&child.name())) {
            return Err(values.wrong(
                "has an axis that is not Cartesian",
                format!("'{}'", other.name()),
                names.join(", "),
            ));
        }
        Ok(children.len())
    }

    /// Numbers of points along the axes of a set of lines; `None` of explicit points.
    /// Errors: a count that is missing or wrong; more points than have numbers of 32 bits.
    pub fn counts(&self) -> Result<Option<[usize; 3]>> {
        let mut counts = [0; 3];
        for (count, (x, i)) in counts.iter_mut().zip(AXES) {
            *count = match self.kind.as_str() {
                "uniform" => self.node.require(&format!("dims/{i}"))?.count()?,
                "rectilinear" => self.node.require(&format!("values/{x}"))?.numbers()?.count,
                _ => return Ok(None),
            };
        }
        let points = counts.iter().fold(1_usize, |product, &count| product.saturating_mul(count));
        if u32::try_from(points).is_err() {
            let found = format!("{} × {} × {} points", counts[0], counts[1], counts[2]);
            return Err(self.node.wrong("has too many points", found, format!("at most {}", u32::MAX)));
        }
        Ok(Some(counts))
    }

    /// The points, the first axis running fastest. Errors: arrays that are missing or of different lengths.
    pub fn points(&self, loan: &Loan) -> Result<SharedSlice<DVec3>> {
        let lines = match self.kind.as_str() {
            "explicit" => return self.explicit(loan),
            "uniform" => {
                let counts = self.counts()?.unwrap_or_default();
                let mut lines: [Vec<f64>; 3] = Default::default();
                for ((line, (x, _)), count) in lines.iter_mut().zip(AXES).zip(counts) {
                    let or = |path: String, default: f64| match self.node.get(&path) {
                        Some(node) => node.number(),
                        None => Ok(default),
                    };
                    let origin = or(format!("origin/{x}"), 0.0)?;
                    let spacing = or(format!("spacing/d{x}"), 1.0)?;
                    *line = (0..count).map(|place| origin + place as f64 * spacing).collect();
                }
                lines
            }
            _ => {
                let mut lines: [Vec<f64>; 3] = Default::default();
                for (line, (x, _)) in lines.iter_mut().zip(AXES) {
                    *line = self.node.require(&format!("values/{x}"))?.numbers()?.to_f64();
                }
                lines
            }
        };
        let [x, y, z] = &lines;
        let row = |(z, y): (f64, f64)| x.iter().map(move |&x| DVec3::new(x, y, z));
        Ok(z.iter().flat_map(|&z| y.iter().map(move |&y| (z, y))).flat_map(row).collect())
    }

    fn explicit(&self, loan: &Loan) -> Result<SharedSlice<DVec3>> {
        let mut axes = Vec::new();
        for (x, _) in AXES {
            axes.push(self.node.require(&format!("values/{x}"))?.numbers()?);
        }
        super::fields::same_lengths(&axes)?;
        // SAFETY: the loan is held as long as the slice, and ends before the simulation goes on.
        if let Some(values) = unsafe { Numbers::lent_tuples(&axes) } {
            let (triples, _) = values.as_chunks::<3>();
            // SAFETY: a DVec3 is three numbers side by side.
            let points =
                unsafe { std::slice::from_raw_parts(triples.as_ptr().cast::<DVec3>(), triples.len()) };
            return Ok(SharedSlice::from_borrowed(points, loan.clone()));
        }
        Ok(Numbers::to_tuples(&axes).as_chunks::<3>().0.iter().map(|&point| DVec3::from(point)).collect())
    }
}
