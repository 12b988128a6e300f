//! `voltet diff`: how much two pictures differ.

use super::shared::{DONE, FAILED, Outcome};
use crate::cli::arguments::Diff;
use crate::cli::present::{name, print, say};
use crate::core::{Error, counted};
use crate::io::encode::{SampleForm, format_by_ending, read_picture};
use crate::nodes::files::{Use, collision, refuse_unwritable, write_whole};
use voltet_study::work_precision::{PreparedPicture, difference, errors};

pub fn diff(arguments: &Diff) -> Outcome {
    let Diff { a, b, output, limit, background, .. } = arguments;
    let format = output.as_deref().map(format_by_ending).transpose()?;
    if let Some(output) = output {
        let of = |path: &std::path::PathBuf, written| Use { path: path.clone(), written };
        if collision(&[of(output, true), of(a, false), of(b, false)]).is_some() {
            let error = Error::usage("the output would overwrite a picture that is compared");
            return Err(error.got(output.display()).expected("another path after --output").into());
        }
        refuse_unwritable(output)?;
    }
    let ((one, one_has_alpha), (other, other_has_alpha)) = (read_picture(a)?, read_picture(b)?);
    if [one.width, one.height] != [other.width, other.height] {
        let sizes = format!("{} × {} and {} × {} pixels", one.width, one.height, other.width, other.height);
        let error = Error::usage("the pictures have different sizes").got(sizes);
        return Err(error.expected("two pictures of one size").in_file(b).into());
    }
    // What has no alpha lies over a background already.
    let has_alpha = one_has_alpha && other_has_alpha;
    let (one, other) =
        if has_alpha { (one, other) } else { (one.over(*background), other.over(*background)) };
    let found = errors(&one, &other);
    let flip = PreparedPicture::new(&one, *background).difference(&PreparedPicture::new(&other, *background));
    let space = match has_alpha {
        true => "premultiplied linear RGBA",
        false => "linear RGB over the background, since a picture has no alpha",
    };
    let size = format!("{} × {} pixels", one.width, one.height);
    let [shown_a, shown_b] = [a, b].map(|path| name(&path.to_string_lossy()).to_string());
    let mut text = format!("{shown_a} and {shown_b}: {size}, {space}\n");
    for (what, error) in [
        ("maximum       ", found.maximum),
        ("99.9 % within ", found.percentile_99_9),
        ("rms           ", found.root_mean_square),
    ] {
        text += &format!("{what}  {error:.3e}  {:>9.4} / 255\n", 255.0 * error);
    }
    let over = counted(found.pixels_over_step, "pixel");
    text += &format!("FLIP, mean      {flip:.3e}\n{over} over 1 / 255\n");
    if let (Some(output), Some(format)) = (output, format) {
        let picture = difference(&one, &other);
        let (file, _) = format.file(&picture, SampleForm::over([0.0; 3]), None)?;
        write_whole(output, &file)?;
    }
    print(&text)?;
    match limit {
        Some(limit) if found.maximum > *limit => {
            say(&format!("the pictures differ by more than {limit}\n"));
            Ok(FAILED)
        }
        _ => Ok(DONE),
    }
}
