//! The table of `docs/instructions.md`.

use crate::selected::{COUNTED, counted};
use costate_routes::cases::Case;
use costate_routes::routes::Failure;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Where the runner keeps what callgrind writes: beside the build of this program,
/// `TARGET/release/deps/instructions-...`.
pub fn home() -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    let folder = program.ancestors().nth(3).map(|target| target.join("gungraun")).unwrap_or_default();
    // Started by cargo, the runner adds the name of the package.
    let of_package = folder.join(env!("CARGO_PKG_NAME"));
    if of_package.is_dir() { of_package } else { folder }
}

/// Instructions of a call: the first number of callgrind's totals.
fn instructions(case: &Case, route: usize) -> Result<u64, Failure> {
    let title = case.title.split(',').next().unwrap_or_default().to_lowercase();
    let folder = home().join(format!("instructions/counted/routes/call.{title}_{route}"));
    let path = folder.join(format!("callgrind.call.{title}_{route}.out"));
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let totals = text.lines().find_map(|line| line.strip_prefix("totals: "));
    let first = totals.and_then(|totals| totals.split_whitespace().next());
    Ok(first.ok_or_else(|| format!("{}: no totals", path.display()))?.parse()?)
}

/// Methods down, robots across.
pub fn table(cases: &[Case], valgrind: &str) -> Result<String, Failure> {
    let titles: Vec<&str> = cases.iter().map(|case| case.title.as_str()).collect();
    let mut text = format!(
        "{valgrind}; rustc as `rust-toolchain.toml` says, link-time optimisation, {} without extensions.\n\n| quantity | method | {} |\n|---|---|{}\n",
        std::env::consts::ARCH,
        titles.join(" | "),
        "---|".repeat(titles.len())
    );
    let mut counts = Vec::new();
    for case in cases {
        let mut of_case = [None; COUNTED.len()];
        for (place, _) in counted(case, |_| true)? {
            of_case[place] = Some(instructions(case, place)?);
        }
        counts.push(of_case);
    }
    for (place, (quantity, route)) in COUNTED.iter().enumerate() {
        write!(text, "| {quantity} | {route} |")?;
        let first = COUNTED.iter().position(|(other, _)| other == quantity).unwrap_or(place);
        for of_case in &counts {
            let cell = of_case[place]
                .zip(of_case[first])
                .map(|(count, first)| format!("{count} ({:.2})", count as f64 / first as f64));
            write!(text, " {} |", cell.unwrap_or_else(|| "-".into()))?;
        }
        text += "\n";
    }
    Ok(text)
}

const BEGIN: &str = "<!-- counts: begin -->\n";
const END: &str = "<!-- counts: end -->";

/// Puts the table between the marks of `docs/instructions.md`.
pub fn write(table: &str) -> Result<(), Failure> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/instructions.md");
    let page = std::fs::read_to_string(&path)?;
    let (before, rest) =
        page.split_once(BEGIN).ok_or("docs/instructions.md has lost the begin of its table")?;
    let (_, after) = rest.split_once(END).ok_or("docs/instructions.md has lost the end of its table")?;
    std::fs::write(path, format!("{before}{BEGIN}{table}{END}{after}"))?;
    println!("written to docs/instructions.md");
    Ok(())
}
