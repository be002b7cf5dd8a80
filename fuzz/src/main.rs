//! Gives mutated inputs to everything of costate that reads files.
//!
//! `cargo run -p costate-fuzz -- --inputs 5000 --seed 1` mutates robots, problem files, saved solutions and
//! states; `cargo run -p costate-fuzz -- --replay` reads the corpus and large inputs. Inputs that cause a
//! panic, take more than 256 MB or 5 s, or cause a message that is not printable, are kept in
//! `fuzz/failures`; the exit status is 1 then.

mod command;
mod files;
mod kind;
mod large;
mod memory;
mod mutate;
mod saved;
mod source;
mod table;
mod target;
mod worker;

use kind::Kind;
use source::{Inputs, Source};
use std::error::Error;
use std::process::ExitCode;
use table::Report;

#[global_allocator]
static ALLOCATOR: memory::Counting = memory::Counting;

const USAGE: &str = "usage: costate-fuzz [--inputs N] [--seed N] [--commands N] [--replay] [--kind NAME]";

/// What is asked for.
struct Arguments {
    inputs: usize,
    commands: Option<usize>,
    seed: u64,
    replay: bool,
    kind: Option<Kind>,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let [first, rest @ ..] = &words[..]
        && first == "--worker"
    {
        start_worker(rest).ok_or("wrong arguments of a worker")?;
        return Ok(ExitCode::SUCCESS);
    }
    let arguments = parse(&words).ok_or(USAGE)?;
    let mut report = Report::default();
    let sources = if arguments.replay {
        vec![Source::Corpus, Source::Large]
    } else {
        vec![Source::Mutated { seed: arguments.seed }]
    };
    for kind in Kind::ALL.into_iter().filter(|&kind| arguments.kind.is_none_or(|only| only == kind)) {
        for &source in &sources {
            let count =
                Inputs::new(kind, source).count().unwrap_or(arguments.inputs.div_ceil(Kind::ALL.len()));
            match kind {
                Kind::Eval => command::evaluate(&command::binary()?, source, count, &mut report)?,
                kind => worker::run(kind, source, count, &mut report)?,
            }
        }
    }
    if !arguments.replay && arguments.kind.is_none() {
        let count = arguments.commands.unwrap_or(arguments.inputs / 20);
        command::commands(&command::binary()?, arguments.seed, count, &mut report)?;
    }
    println!("{report}");
    Ok(if report.is_good() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn parse(words: &[String]) -> Option<Arguments> {
    let mut arguments = Arguments { inputs: 5000, commands: None, seed: 1, replay: false, kind: None };
    let mut words = words.iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--inputs" => arguments.inputs = words.next()?.parse().ok()?,
            "--commands" => arguments.commands = Some(words.next()?.parse().ok()?),
            "--seed" => arguments.seed = words.next()?.parse().ok()?,
            "--kind" => arguments.kind = Some(Kind::from_name(words.next()?)?),
            "--replay" => arguments.replay = true,
            _ => return None,
        }
    }
    Some(arguments)
}

/// `KIND SOURCE SEED FIRST END`.
fn start_worker(words: &[String]) -> Option<()> {
    let [kind, source, seed, first, end] = words else { return None };
    let (kind, source) = (Kind::from_name(kind)?, Source::from_words(source, seed)?);
    worker::work(kind, source, first.parse().ok()?, end.parse().ok()?);
    Some(())
}
