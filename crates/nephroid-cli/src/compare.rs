//! `nephroid compare`: how far a picture is from its reference.

use nephroid::film::{ImageError, difference_picture};
use nephroid_formats::image::{check_writable, write_png};
use serde_json::json;

use crate::args::CompareArgs;
use crate::console::{self, Messages};
use crate::exit::{Exit, Failure};
use crate::output::{Kind, Output, read};

/// Prints the measures, and draws the difference if asked to.
pub fn run(args: &CompareArgs) -> Result<Exit, Failure> {
    let picture_path = args.output.as_deref().map(|path| Output::of_kind(path, Kind::Png)).transpose()?;
    if let Some(output) = &picture_path {
        check_writable(&output.path).map_err(|e| Failure::File(e.to_string()))?;
    }
    let (image, reference) = (read(&args.image)?, read(&args.reference)?);
    let mismatch = |e: nephroid::film::SizeMismatch| Failure::File(format!("cannot compare: {e}"));
    let error = ImageError::between(&image, &reference, args.epsilon).map_err(mismatch)?;
    if error.non_finite > 0 {
        let message = format!("{} pixels are not finite in one of them, and are left out", error.non_finite);
        Messages::default().warning(&message);
    }
    if args.json {
        let object = json!({
            "rmse": error.rmse,
            "rel_mse": error.rel_mse,
            "mean_ratio": error.mean_ratio,
            "epsilon": args.epsilon,
            "non_finite": error.non_finite,
        });
        console::result(&format!("{object}\n"))?;
    } else {
        console::result(&format!(
            "RMSE        {:.6e}\nrelMSE      {:.6e}\nmean ratio  {:.6}\n",
            error.rmse, error.rel_mse, error.mean_ratio
        ))?;
    }
    if let Some(output) = &picture_path {
        let picture = difference_picture(&image, &reference, None).map_err(mismatch)?;
        write_png(&output.path, &picture).map_err(|e| Failure::File(e.to_string()))?;
    }
    Ok(Exit::Done)
}
