//! Vectors that a file holds as three variables: `disp_x`, `disp_y` and `disp_z` are the vector `disp`, as in VTK's readers.

use super::contents::Stored;
use super::numbers::NumberType;
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
                let first = axes[0].number_type;
                let is_of_one_type = axes.iter().all(|axis| axis.number_type == first);
                let number_type = if is_of_one_type { first } else { NumberType::F64 };
                Ok(Stored { number_type, ..Stored::joined(&self.name, axes) })
            }
            _ => Ok(Stored { name: self.name.clone(), ..variable(self.places[0])? }),
        }
    }
}

/// The arrays of variables with these names: a vector of each three that end in x, y and z, in small letters or capitals, in the place of
/// the first; others by themselves. Some writers list a variable again: a further one of a name has its number among these.
pub(super) fn joined(names: &[String]) -> Vec<Joined> {
    joined_if(names, |_| true)
}

/// As [`joined`], of the vectors whose components, by their places, may be joined.
pub(super) fn joined_if(names: &[String], may_be_joined: impl Fn(&[usize; 3]) -> bool) -> Vec<Joined> {
    let mut vectors: Vec<(&str, [usize; 3])> = Vec::new();
    for is_same_case in [true, false] {
        let found = (0..names.len()).filter_map(|first| vector(first, names, is_same_case));
        for (stem, places) in found.filter(|(_, places)| may_be_joined(places)) {
            // A scalar may have the vector's name.
            if names.iter().all(|name| name != stem) && vectors.iter().all(|own| own.0 != stem) {
                vectors.push((stem, places));
            }
        }
    }
    let mut arrays = Vec::new();
    for (place, own) in names.iter().enumerate() {
        match vectors.iter().find(|(_, places)| places.contains(&place)) {
            Some((stem, places)) if places.iter().all(|&other| other >= place) => {
                let components = ["x", "y", "z"].map(str::to_owned).to_vec();
                arrays.push(Joined { name: (*stem).to_owned(), places: places.to_vec(), components });
            }
            Some(_) => {}
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

/// Name of the vector whose first component is a variable, and the places of all three; their letters x, y and z are all small or all
/// capitals where `is_same_case`.
fn vector(first: usize, names: &[String], is_same_case: bool) -> Option<(&str, [usize; 3])> {
    let name = names[first].as_str();
    let start = name.strip_suffix(['x', 'X'])?;
    let stem = start.trim_end_matches(['_', ' ', '.', '-']);
    if stem.is_empty() || (stem.len() == start.len() && is_tensor(stem, names)) {
        return None;
    }
    let is_capital = name.ends_with('X');
    let place = |axis: char| {
        let is_axis = |last: char| {
            last.eq_ignore_ascii_case(&axis) && (!is_same_case || last.is_ascii_uppercase() == is_capital)
        };
        names.iter().position(|name| name.strip_suffix(is_axis) == Some(start))
    };
    Some((stem, [first, place('y')?, place('z')?]))
}

/// True if components of this stem are a row of a tensor, as `stress_xx`, `stress_xy` and `stress_xz` are: there are components of
/// another row, as `stress_yy`. `VELOCITYX` has none beside it.
fn is_tensor(stem: &str, names: &[String]) -> bool {
    let axes = ['x', 'y', 'z', 'X', 'Y', 'Z'];
    let Some(start) = stem.strip_suffix(axes) else { return false };
    let row = &stem[start.len()..];
    names.iter().any(|name| {
        let end = name.strip_prefix(start).filter(|end| end.len() == 2);
        let other = end.and_then(|end| end.strip_suffix(axes)).filter(|other| other.ends_with(axes));
        other.is_some_and(|other| !other.eq_ignore_ascii_case(row))
    })
}

/// Length of a vector, without overflow on the way.
pub fn length(vector: &[f64]) -> f64 {
    let scale = vector.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
    if scale == 0.0 || !scale.is_finite() || vector.iter().any(|value| value.is_nan()) {
        return vector.iter().map(|value| value.abs()).sum();
    }
    scale * vector.iter().map(|value| (value / scale).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::contents::Encoding;
    use super::super::source::Source;
    use super::*;

    #[test]
    fn three_components_are_a_vector() {
        let names = |all: &str| all.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let of =
            |all: &str| joined(&names(all)).into_iter().map(|array| array.name).collect::<Vec<_>>().join(" ");
        assert_eq!(of("T disp_x disp_y disp_z p"), "T disp p");
        assert_eq!(of("VELX VELY VELZ"), "VEL");
        for tensor in [
            "stress_xx stress_xy stress_xz stress_yy stress_yz stress_zz",
            "ReynoldsStressXX ReynoldsStressXY ReynoldsStressXZ ReynoldsStressYY ReynoldsStressYZ ReynoldsStressZZ",
            "gradXx gradXy gradXz gradYx gradYy gradYz gradZx gradZy gradZz",
        ] {
            assert_eq!(of(tensor), tensor);
        }
        for stem in ["VELOCITY", "VORTICITY", "ENERGY", "fluxX", "ReynoldsStressX"] {
            assert_eq!(of(&format!("{stem}X {stem}Y {stem}Z VELOCITY_RMS")), format!("{stem} VELOCITY_RMS"));
        }
        assert_eq!(of("disp disp_x disp_y disp_z"), "disp disp_x disp_y disp_z");
        assert_eq!(of("x y z"), "x y z");
        assert_eq!(of("id map id id"), "id map id (2) id (3)");
        assert_eq!(of("disp_x disp_y"), "disp_x disp_y");
        assert_eq!(of("u_x u_y u_z u_x u_y u_z"), "u u_x (2) u_y (2) u_z (2)");
        assert_eq!(of("VelocityX VelocityXRMS VelocityY VelocityZ"), "Velocity VelocityXRMS");
        assert_eq!(of("Velocity_X Velocity_Y Velocity_Z"), "Velocity");
        assert_eq!(of("_x _y _z u_X u_y u_z"), "_x _y _z u");
        assert_eq!(of("u_X u_x u_y u_z"), "u_X u");
        assert_eq!(of("u_z u_y T u_x"), "u T");
        assert_eq!(joined(&names("u_z u_y T u_x"))[0].places, [3, 1, 0]);
        assert_eq!(joined(&names("p v_x v_y v_z"))[1].places, [1, 2, 3]);
        assert_eq!(joined_if(&names("v_x v_y v_z"), |places| *places != [0, 1, 2]).len(), 3);
    }

    #[test]
    fn a_vector_is_of_its_components_type_or_of_doubles() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, [0; 8]).unwrap();
        let source = Source::open(&path).unwrap();
        let vector = &joined(&["v_x", "v_y", "v_z"].map(str::to_owned))[0];
        for (types, expected) in [
            ([NumberType::F32; 3], NumberType::F32),
            ([NumberType::F32, NumberType::F64, NumberType::F32], NumberType::F64),
        ] {
            let variable = |place: usize| {
                Ok(Stored {
                    number_type: types[place],
                    ..Stored::of_f64(&source, "v", 1, 1, Encoding::Bytes(0))
                })
            };
            assert_eq!(vector.stored(variable).unwrap().number_type, expected);
        }
    }
}
