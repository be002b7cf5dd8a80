//! Writes the Rust text of F, F_x and y'F_xx of every robot that is not too large into `OUT_DIR`, and a list
//! of it.

#[path = "src/robots.rs"]
mod robots;

use costate::codegen::{Coordinates, Program, ProgramOptions, Quantity, RustOptions, robot_program};
use std::error::Error;
use std::fmt::Write;

/// Most steps of a text: rustc takes a second for 500 to 1000 steps of one kind of number, and there are
/// three.
const LIMIT: usize = 10_000;
/// Where nothing is timed.
const LIMIT_OF_TESTS: usize = 1_000;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=../../robots");
    println!("cargo::rerun-if-changed=src/robots.rs");
    let limit = if std::env::var("PROFILE")? == "release" { LIMIT } else { LIMIT_OF_TESTS };
    let files = robots::FILES.map(|(_, file)| robots::from_file(file));
    let chains = robots::CHAINS.map(robots::chain);
    let (mut modules, mut list) = (String::new(), String::new());
    for robot in files.into_iter().chain(chains) {
        let robot = robot?;
        for quantity in [Quantity::F, Quantity::FX, Quantity::YFXX] {
            let program =
                robot_program(&robot, quantity, Coordinates::Hamiltonian, &ProgramOptions::default())?;
            if program.steps() > limit {
                break;
            }
            let name = program.name();
            // The first text defines what a number is, the others ask for that.
            let number = (!modules.is_empty()).then(|| "super::Number".to_owned());
            let text = program.to_rust(&RustOptions::default().with_number(number).with_limit(limit))?;
            if modules.is_empty() {
                writeln!(modules, "use {name}::Number;")?;
            }
            writeln!(modules, "mod {name} {{\n{text}}}")?;
            writeln!(modules, "{}", wrapper(&program))?;
            writeln!(
                list,
                "    Text {{ robot: {:?}, quantity: {:?}, one: {name}::<f64>, four: {name}::<F64x4>, eight: {name}::<F64x8> }},",
                robot.name(),
                quantity.name(),
            )?;
        }
    }
    let list = format!("/// All of it.\npub const TEXTS: &[Text] = &[\n{list}];\n");
    std::fs::write(format!("{}/texts.rs", std::env::var("OUT_DIR")?), modules + &list)?;
    Ok(())
}

/// A function on slices, whatever the size of the robot.
fn wrapper(program: &Program) -> String {
    let name = program.name();
    let inputs = program.arguments().iter().map(|a| format!("(&a.{}[..]).try_into()?", a.name));
    let outputs = program.results().iter().map(|r| format!("(&mut a.{}[..]).try_into()?", r.name));
    let all: Vec<String> = inputs.chain(outputs).collect();
    format!(
        "fn {name}<T: Number>(a: &mut Arrays<T>) -> Result<(), TryFromSliceError> {{\n    {name}::{name}({});\n    Ok(())\n}}",
        all.join(", ")
    )
}
