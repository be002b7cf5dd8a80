//! What the quantities are computed with.

use costate::constraints::ConstrainedHamiltonianSecondOrder;
use costate::contacts::{Contact, Stance};
use costate::hamiltonian::{DualPass, Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::robot::{LoadOptions, Placement, Robot, Tree};
use std::error::Error;
use std::path::Path;

/// Lengths of q, of v, and of the forces of the ground.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub nq: usize,
    pub n: usize,
    pub k: usize,
}

/// Everything that is allocated.
pub struct Workspaces {
    size: Size,
    pub hamiltonian: Hamiltonian<f64>,
    pub second: HamiltonianSecondOrder<f64>,
    pub dual_pass: DualPass<f64>,
    pub lagrangian: Lagrangian<f64>,
    pub lagrangian_second: LagrangianSecondOrder<f64>,
    /// On the feet of the robot, if it has any.
    pub standing: ConstrainedHamiltonianSecondOrder<f64>,
}

impl Workspaces {
    /// Those of the robot in a URDF file; links that stand on the ground are in a file with the extension
    /// `stance` beside it.
    pub fn open(path: &str) -> Result<Self, Box<dyn Error>> {
        let robot = Robot::from_file_with(path, LoadOptions::default().quaternions(true))?;
        let feet = match std::fs::read_to_string(Path::new(path).with_extension("stance")) {
            Ok(text) => text.lines().map(foot).collect::<Result<Vec<_>, _>>()?,
            Err(_) => Vec::new(),
        };
        let stance = Stance::new(&robot, &feet)?;
        let tree = Tree::from(&robot);
        Ok(Self {
            size: Size { nq: tree.nq(), n: tree.dof(), k: stance.count() },
            hamiltonian: Hamiltonian::from_tree(tree.clone()),
            second: HamiltonianSecondOrder::from_tree(tree.clone()),
            dual_pass: DualPass::from_tree(tree.clone()),
            lagrangian: Lagrangian::from_tree(tree.clone()),
            lagrangian_second: LagrangianSecondOrder::from_tree(tree),
            standing: ConstrainedHamiltonianSecondOrder::new(stance.robot()),
        })
    }

    /// Lengths of the arrays.
    pub fn size(&self) -> Size {
        self.size
    }
}

/// A link, and where the ground beneath it is, by position and angles.
fn foot(line: &str) -> Result<Contact, Box<dyn Error>> {
    let mut words = line.split_whitespace();
    let link = words.next().ok_or("a foot without a name")?;
    let numbers = words.map(str::parse::<f64>).collect::<Result<Vec<_>, _>>()?;
    let &[x, y, z, roll, pitch, yaw] = numbers.as_slice() else {
        return Err("not six numbers for a foot".into());
    };
    Ok(Contact::foot(link, link).on(Placement::from_xyz_rpy([x, y, z], [roll, pitch, yaw])))
}
