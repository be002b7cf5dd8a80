//! Writes straight-line code for some robots into `OUT_DIR`.

use costate::codegen::{Coordinates, ProgramOptions, Quantity, RustOptions, robot_program};
use costate::robot::Robot;
use costate_control::{ProgramOf, pontryagin_program};
use std::error::Error;
use std::path::Path;

#[path = "src/problems.rs"]
mod problems;

fn main() -> Result<(), Box<dyn Error>> {
    let robots = Path::new(&std::env::var("CARGO_MANIFEST_DIR")?).join("../../robots");
    let out = std::env::var("OUT_DIR")?;
    let (hamiltonian, lagrangian) = (Coordinates::Hamiltonian, Coordinates::Lagrangian);
    for (file, quantity, coordinates, number) in [
        ("ur5.urdf", Quantity::YFXX, hamiltonian, None),
        ("panda.urdf", Quantity::FX, hamiltonian, None),
        ("cart_pole.toml", Quantity::FX, lagrangian, None),
        ("manutec_r3.toml", Quantity::F, hamiltonian, Some("costate::scalar::Scalar".into())),
        ("../examples/problems/robots/satellite.toml", Quantity::FX, lagrangian, None),
        ("../examples/problems/robots/satellite.toml", Quantity::HessianProduct, hamiltonian, None),
    ] {
        let path = robots.join(file);
        println!("cargo::rerun-if-changed={}", path.display());
        let program =
            robot_program(&Robot::from_file(path)?, quantity, coordinates, &ProgramOptions::default())?;
        let source = program.to_rust(&RustOptions::default().with_number(number))?;
        std::fs::write(Path::new(&out).join(format!("{}.rs", program.name())), source)?;
    }
    // The extremals of two problems: whole, and without their Jacobian.
    println!("cargo::rerun-if-changed=src/problems.rs");
    for of in ProgramOf::ALL {
        for problem in [problems::two_link(&robots)?, problems::manutec_r3(&robots)?] {
            let program = pontryagin_program(&problem, of)?;
            let source = program.to_rust(&RustOptions::default())?;
            std::fs::write(Path::new(&out).join(format!("{}.rs", program.name())), source)?;
        }
    }
    Ok(())
}
