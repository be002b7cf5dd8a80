//! What the programs behind pages of docs/ share: the table between its marks, colours and legend of curves.

use plotters::coord::CoordTranslate;
use plotters::prelude::*;
use std::error::Error;

pub const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
const BEGIN: &str = "<!-- table: begin -->";
const END: &str = "<!-- table: end -->";

/// Colours of curves, which colour-blind people tell apart.
pub const COLORS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(86, 40, 130)];

/// Prints a table, and writes it between the marks of a page of docs/.
pub fn write_table(page: &str, table: &str) -> Result<(), Box<dyn Error>> {
    println!("{table}");
    let path = format!("{ROOT}/docs/{page}");
    let text = std::fs::read_to_string(&path)?;
    let lost = |mark: &str| format!("docs/{page} has lost the {mark} of its table");
    let (before, rest) = text.split_once(BEGIN).ok_or_else(|| lost("begin"))?;
    let (_, after) = rest.split_once(END).ok_or_else(|| lost("end"))?;
    std::fs::write(path, format!("{before}{BEGIN}\n{table}{END}{after}"))?;
    Ok(())
}

/// Draws the names of the curves.
pub fn legend<'a, DB: DrawingBackend + 'a, CT: CoordTranslate>(
    chart: &mut ChartContext<'a, DB, CT>,
    position: SeriesLabelPosition,
) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>> {
    chart
        .configure_series_labels()
        .position(position)
        .label_font(("sans-serif", 18))
        .background_style(WHITE.mix(0.9))
        .border_style(BLACK.mix(0.4))
        .legend_area_size(32)
        .draw()
}
