//! Vectors that a file holds as three variables: `disp_x`, `disp_y` and `disp_z` are the vector `disp`, as in VTK's reader.

/// An array that variables make up: its name, their places, and the names of its components.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Joined {
    pub name: String,
    pub places: Vec<usize>,
    pub components: Vec<String>,
}

/// The arrays of variables with these names: a vector of each three that follow one another and end in x, y and z; others by
/// themselves. Some writers list a variable again: a further one of a name has its number among these.
pub(super) fn joined(names: &[String]) -> Vec<Joined> {
    let mut arrays: Vec<Joined> = Vec::new();
    let mut place = 0;
    while place < names.len() {
        let vector = names.get(place..place + 3).and_then(stem);
        // A scalar may have the vector's name.
        match vector.filter(|stem| !names.contains(stem) && !arrays.iter().any(|array| array.name == *stem)) {
            Some(name) => {
                let components = ["x", "y", "z"].map(str::to_owned).to_vec();
                arrays.push(Joined { name, places: vec![place, place + 1, place + 2], components });
                place += 3;
            }
            None => {
                let own = &names[place];
                let name = match names[..place].iter().filter(|name| *name == own).count() {
                    0 => own.clone(),
                    before => format!("{own} ({})", before + 1),
                };
                arrays.push(Joined { name, places: vec![place], components: Vec::new() });
                place += 1;
            }
        }
    }
    arrays
}

/// The name of the vector that three variables are the components of.
fn stem(names: &[String]) -> Option<String> {
    let split = |name: &String| {
        let (place, last) = name.char_indices().next_back()?;
        Some((name[..place].to_owned(), last.to_ascii_lowercase()))
    };
    let parts: Option<Vec<(String, char)>> = names.iter().map(split).collect();
    let [(first, 'x'), (second, 'y'), (third, 'z')] = &parts?[..] else { return None };
    let stem = first.trim_end_matches(['_', ' ', '.', '-']);
    // A row of a tensor ends in two letters of axes: `stress_xx`.
    let is_tensor = stem.len() == first.len() && stem.ends_with(['x', 'y', 'z', 'X', 'Y', 'Z']);
    (first == second && second == third && !stem.is_empty() && !is_tensor).then(|| stem.to_owned())
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
        assert_eq!(joined(&names("p v_x v_y v_z"))[1].places, [1, 2, 3]);
    }
}
