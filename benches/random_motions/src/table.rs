//! The table of the study.

use crate::kinds::KINDS;
use crate::record::Record;
use std::collections::BTreeMap;
use std::fmt::Write;

/// One row for each kind, and one for all.
pub fn table(records: &[Record]) -> String {
    let mut text = String::from(
        "| kind | motions | converged | wrong cost | beyond tolerance | cheaper found | beyond tolerance | cheaper known | limits broken \
         | of these not reported | not judged | others | median ms | most ms |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let rows = KINDS
        .iter()
        .map(|kind| (kind.name, records.iter().filter(|record| record.kind == kind.name).collect()));
    let rows: Vec<(&str, Vec<&Record>)> = rows.chain([("all", records.iter().collect())]).collect();
    for (name, records) in rows.iter().filter(|(_, records)| !records.is_empty()) {
        let converged: Vec<&&Record> = records.iter().filter(|record| record.is_converged()).collect();
        let faults = |fault: &str| converged.iter().filter(|record| record.has(fault)).count();
        let beyond = |fault: &str, of: fn(&Record) -> Option<f64>| {
            let is =
                |record: &Record| record.has(fault) && of(record).is_none_or(|off| off > record.tolerance);
            converged.iter().filter(|record| is(record)).count()
        };
        let hidden = converged.iter().filter(|record| {
            record.excesses.iter().any(|excess| excess.kind != "torque cut" && !excess.reported)
        });
        let mut others: BTreeMap<&str, usize> = BTreeMap::new();
        for record in records.iter().filter(|record| !record.is_converged()) {
            *others.entry(&record.status).or_default() += 1;
        }
        let others: Vec<String> = others.iter().map(|(status, count)| format!("{status} {count}")).collect();
        let mut times: Vec<f64> = records.iter().map(|record| record.milliseconds).collect();
        times.sort_by(f64::total_cmp);
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.0} | {:.0} |",
            records.len(),
            converged.len(),
            faults("wrong cost"),
            beyond("wrong cost", |record| record.cost_off),
            faults("cheaper found"),
            beyond("cheaper found", |record| record.cheaper),
            faults("cheaper known"),
            faults("limits broken"),
            hidden.count(),
            converged.iter().filter(|record| !record.not_judged.is_empty()).count(),
            others.join(", "),
            times[times.len() / 2],
            times[times.len() - 1],
        );
    }
    text
}

/// One line for each fault of a converged motion.
pub fn faults(records: &[Record]) -> String {
    let mut text = String::new();
    let number = |x: Option<f64>| x.map_or("-".into(), |x| format!("{x:.3e}"));
    for record in records.iter().filter(|record| !record.faults.is_empty()) {
        let excesses: Vec<String> = record
            .excesses
            .iter()
            .filter(|excess| excess.kind != "torque cut")
            .map(|excess| {
                format!("{} of {} by {:.1e} at {:.4} s", excess.kind, excess.name, excess.part, excess.t)
            })
            .collect();
        let _ = writeln!(
            text,
            "{}-{}-{} {:?}: {}; cost {:.9}, stated error {}, own cost off by {}, cheaper by {} ({}, {} to {} intervals); {}{}",
            record.kind,
            record.seed,
            record.number,
            record.parts,
            record.faults.join(", "),
            record.cost.unwrap_or(f64::NAN),
            number(record.stated_error),
            number(record.cost_off),
            number(record.cheaper),
            record.finer.as_deref().unwrap_or("no finer mesh"),
            record.intervals,
            record.finer_intervals,
            record.known_cost.map_or(String::new(), |known| format!("known: {known:.9}; ")),
            excesses.join(", "),
        );
    }
    text
}
