//! The tables of `docs/scaling.md`.

use crate::accuracy::{Error, judge};
use costate_routes::cases::Case;
use costate_routes::routes::Failure;
use costate_routes::{FIRST, FUNCTION, NODES, SECOND};
use std::fmt::Write;

/// The folder of the project.
pub const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Batches of which the median is taken.
pub const BATCHES: usize = 31;

/// What is known of one method for one quantity of one robot.
pub struct Row {
    pub case: String,
    pub quantity: &'static str,
    pub route: &'static str,
    pub error: Error,
    /// None where it was left out by a filter on the command line.
    pub time: Option<Time>,
}

/// Median (ns), and of how many batches.
#[derive(Clone, Copy)]
pub struct Time {
    pub median: f64,
    pub batches: usize,
}

/// What the program is compiled for, and the section of the page that holds its tables.
pub const INSTRUCTIONS: &str = if cfg!(target_feature = "avx512f") {
    "AVX-512"
} else if cfg!(target_feature = "avx2") {
    "AVX2 and FMA"
} else {
    "baseline instructions of the target"
};
pub const BASELINE: bool = !cfg!(target_feature = "avx2");
const SECTION: &str = if BASELINE { "any processor" } else { "this processor" };

/// The method that others are compared with: what a user of the library gets.
fn first_choice(quantity: &str) -> &'static str {
    if quantity == SECOND { RULE } else { "analytic" }
}
const RULE: &str = "2n+1 rule";
const PASS: &str = "one dual pass through F_x";

/// Times, errors and the factors between hand-derived and automatic second derivatives.
pub fn tables(cases: &[Case], rows: &[Row]) -> Result<String, Failure> {
    let lto = if option_env!("CARGO_PROFILE_BENCH_LTO").is_some()
        || option_env!("CARGO_PROFILE_RELEASE_LTO").is_some()
    {
        "link-time optimisation as the environment says"
    } else {
        "fat link-time optimisation, one codegen unit"
    };
    let mut text = format!(
        "CPU {}; one core, f64, {INSTRUCTIONS}, {lto}; medians of {BATCHES} batches, with * of fewer (calls above 0.1 s: 10).\n",
        processor()
    );
    for (title, quantity) in [("F", FUNCTION), ("F and F_x", FIRST), ("F, F_x and y'F_xx", SECOND)] {
        let first = first_choice(quantity);
        write!(
            text,
            "\n### {title}\n\nTime of one state, and in brackets as a multiple of the method \"{first}\".\n\n"
        )?;
        table(&mut text, cases, rows, quantity, |row| {
            let base = find(rows, &row.case, quantity, first)?.time?.median;
            let Time { median, batches } = row.time?;
            let mark = if batches < BATCHES { "*" } else { "" };
            Some(format!("{}{mark} ({})", duration(median), ratio(median / base)))
        })?;
        let judge = judge(quantity);
        write!(text, "\nRelative error of the worst block, and which that is; b by \"{judge}\".\n\n")?;
        table(&mut text, cases, rows, quantity, |row| {
            Some(if row.route == judge { "judge".into() } else { row.error.to_string() })
        })?;
    }
    factors(&mut text, cases, rows)?;
    Ok(text)
}

fn find<'a>(rows: &'a [Row], case: &str, quantity: &str, route: &str) -> Option<&'a Row> {
    rows.iter().find(|row| row.case == case && row.quantity == quantity && row.route == route)
}

/// Methods for a quantity, in the order in which they first appear.
pub fn routes(rows: &[Row], quantity: &str) -> Vec<&'static str> {
    let mut routes = Vec::new();
    for row in rows.iter().filter(|row| row.quantity == quantity) {
        if !routes.contains(&row.route) {
            routes.push(row.route);
        }
    }
    routes
}

fn table(
    text: &mut String,
    cases: &[Case],
    rows: &[Row],
    quantity: &str,
    cell: impl Fn(&Row) -> Option<String>,
) -> std::fmt::Result {
    header(text, "method", cases)?;
    for route in routes(rows, quantity) {
        write!(text, "| {route} |")?;
        for case in cases {
            let cell = find(rows, &case.title, quantity, route).and_then(&cell);
            write!(text, " {} |", cell.unwrap_or_else(|| "-".into()))?;
        }
        writeln!(text)?;
    }
    Ok(())
}

fn header(text: &mut String, first: &str, cases: &[Case]) -> std::fmt::Result {
    let titles: Vec<&str> = cases.iter().map(|case| case.title.as_str()).collect();
    writeln!(text, "| {first} | {} |\n|---|{}", titles.join(" | "), "---|".repeat(titles.len()))
}

/// How many times faster the hand-derived second derivatives are than hyper-dual pairs.
fn factors(text: &mut String, cases: &[Case], rows: &[Row]) -> std::fmt::Result {
    write!(
        text,
        "\n### Hand-derived against automatic\n\nHow many times longer hyper-dual pairs take for y'F_xx.\n\n"
    )?;
    header(text, "than", cases)?;
    for route in [RULE, PASS] {
        write!(text, "| {route} |")?;
        for case in cases {
            let time = |route| Some(find(rows, &case.title, SECOND, route)?.time?.median);
            let factor = time(judge(SECOND)).zip(time(route)).map(|(slow, fast)| ratio(slow / fast));
            write!(text, " {} |", factor.unwrap_or_else(|| "-".into()))?;
        }
        writeln!(text)?;
    }
    Ok(())
}

/// Two digits behind the point below ten, one below a hundred.
fn ratio(value: f64) -> String {
    let digits = if value < 9.995 { 2 } else { usize::from(value < 99.95) };
    format!("{value:.digits$}")
}

/// Three digits and a unit.
pub fn duration(ns: f64) -> String {
    let (value, unit) = match ns {
        ns if ns < 999.5 => (ns, "ns"),
        ns if ns < 999.5e3 => (ns / 1e3, "µs"),
        ns if ns < 999.5e6 => (ns / 1e6, "ms"),
        ns => (ns / 1e9, "s"),
    };
    format!("{} {unit}", ratio(value))
}

/// Name of the processor.
pub fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    model.map_or("unknown", |(_, name)| name.trim()).to_owned()
}

/// Puts the tables between the marks of their section of `docs/scaling.md`.
pub fn write(tables: &str) -> Result<(), Failure> {
    let path = format!("{ROOT}/docs/scaling.md");
    let page = std::fs::read_to_string(&path)?;
    let (begin, end) = (format!("<!-- {SECTION}: begin -->\n"), format!("<!-- {SECTION}: end -->"));
    let (before, rest) = page.split_once(&begin).ok_or("docs/scaling.md has lost the begin of its tables")?;
    let (_, after) = rest.split_once(&end).ok_or("docs/scaling.md has lost the end of its tables")?;
    std::fs::write(path, format!("{before}{begin}{tables}{end}{after}"))?;
    println!("{NODES} states in a batch; written to docs/scaling.md, section \"{SECTION}\"");
    Ok(())
}
