//! Vectors that a file holds as three variables: `disp_x`, `disp_y` and `disp_z` are the vector `disp`, as in VTK's readers.

use super::contents::Stored;
use voltet_core::Result;

/// An array that variables make up: its name, their places, and the names of its components.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Joined {
    pub name: String,
    pub places: Vec<usize>,
    pub components: Vec<String>,
}

impl Joined {
    /// The array, of the variables that `variable` gives by their places.
    pub fn stored(&self, variable: impl Fn(usize) -> Result<Stored>) -> Result<Stored> {
        match self.places[..] {
            [x, y, z] => {
                let axes = [variable(x)?, variable(y)?, variable(z)?];
                let number_type = axes[0].number_type;
                Ok(Stored { number_type, ..Stored::joined(&self.name, axes) })
            }
            _ => Ok(Stored { name: self.name.clone(), ..variable(self.places[0])? }),
        }
    }
}

/// The arrays of variables with these names: a vector of each three that end in x, y and z, or in X, Y and Z, in the place of the first;
/// others by themselves. Some writers list a variable again: a further one of a name has its number among these.
pub(super) fn joined(names: &[String]) -> Vec<Joined> {
    let mut arrays: Vec<Joined> = Vec::new();
    let mut is_taken = vec![false; names.len()];
    for (place, own) in names.iter().enumerate() {
        if is_taken[place] {
            continue;
        }
        // A scalar may have the vector's name.
        let is_free = |stem: &str| {
            names.iter().all(|name| name != stem) && arrays.iter().all(|array| array.name != stem)
        };
        match vector(place, names).filter(|(stem, _)| is_free(stem)) {
            Some((name, places)) => {
                places.iter().for_each(|&place| is_taken[place] = true);
                let components = ["x", "y", "z"].map(str::to_owned).to_vec();
                arrays.push(Joined { name, places, components });
            }
            None => {
                let name = match names[..place].iter().filter(|name| *name == own).count() {
                    0 => own.clone(),
                    before => format!("{own} ({})", before + 1),
                };
                arrays.push(Joined { name, places: vec![place], components: Vec::new() });
            }
        }
    }
    arrays
}

/// Name of the vector whose first component is a variable, and the places of all three.
fn vector(first: usize, names: &[String]) -> Option<(String, Vec<usize>)> {
    let (start, axes) = match names[first].strip_suffix('x') {
        Some(start) => (start, ['x', 'y', 'z']),
        None => (names[first].strip_suffix('X')?, ['X', 'Y', 'Z']),
    };
    let stem = start.trim_end_matches(['_', ' ', '.', '-']);
    // A row of a tensor ends in two letters of axes: `stress_xx`.
    let is_tensor = stem.len() == start.len() && stem.ends_with(axes);
    if stem.is_empty() || is_tensor {
        return None;
    }
    let place = |axis: char| names.iter().position(|name| name.strip_suffix(axis) == Some(start));
    Some((stem.to_owned(), vec![first, place(axes[1])?, place(axes[2])?]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_components_are_a_vector() {
        let names = |all: &str| all.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let of =
            |all: &str| joined(&names(all)).into_iter().map(|array| array.name).collect::<Vec<_>>().join(" ");
        assert_eq!(of("T disp_x disp_y disp_z p"), "T disp p");
        assert_eq!(of("VELX VELY VELZ"), "VEL");
        assert_eq!(of("stress_xx stress_xy stress_xz"), "stress_xx stress_xy stress_xz");
        assert_eq!(of("disp disp_x disp_y disp_z"), "disp disp_x disp_y disp_z");
        assert_eq!(of("x y z"), "x y z");
        assert_eq!(of("id map id id"), "id map id (2) id (3)");
        assert_eq!(of("disp_x disp_y"), "disp_x disp_y");
        assert_eq!(of("u_x u_y u_z u_x u_y u_z"), "u u_x (2) u_y (2) u_z (2)");
        assert_eq!(of("VelocityX VelocityXRMS VelocityY VelocityZ"), "Velocity VelocityXRMS");
        assert_eq!(of("Velocity_X Velocity_Y Velocity_Z"), "Velocity");
        assert_eq!(of("_x _y _z u_X u_y u_z"), "_x _y _z u_X u_y u_z");
        assert_eq!(joined(&names("p v_x v_y v_z"))[1].places, [1, 2, 3]);
    }
}
