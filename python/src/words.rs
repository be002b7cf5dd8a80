//! Messages of the library in the words of its Python interface.

/// What messages advise on the command line and in Rust, and what does the same here.
const WORDS: [(&str, &str); 23] = [
    ("`costate info --frames` lists the names", "robot.frame_names lists the names"),
    ("request it by --friction (LoadOptions::friction)", "request it by friction=True"),
    ("request it by --floating-base (LoadOptions::floating_base)", "request it by floating_base=True"),
    ("request it by --quaternions (LoadOptions::quaternions)", "request it by quaternions=True"),
    ("give the format by --format (Robot::read)", "give the text and its format to Robot.from_text"),
    ("or give --format urdf", "or give the text and format=\"urdf\" to Robot.from_text"),
    ("or give --format toml", "or give the text and format=\"toml\" to Robot.from_text"),
    ("(--limit ", "(limit="),
    ("(--limit)", "(limit=...)"),
    ("or --only)", "or only=True)"),
    ("; `costate info ROBOT --frames` lists them", "; robot.frame_names lists them"),
    ("; `costate info` lists the names", "; robot.all_joint_names lists the names"),
    // Python compiles with a limit that the robot decides.
    (
        ". Use the generic code, choose a smaller quantity (y_f_x, y_f_xx_d), or raise the limit with \
      Compiled::<f64>::with_limit or JitQuantity::with_limit",
        ". `adjoint` and `hvp` are shorter",
    ),
    (
        ". Use the generic code, choose a smaller quantity (y_f_x, y_f_xx_d), or raise the limit with \
      JitQuantity::with_limit",
        ". `adjoint` and `hvp` are shorter",
    ),
    ("give its folder with --package-path", "give its folder by package_path=[...]"),
    (
        "`Hamiltonian`, `ConstrainedHamiltonian` and `Lagrangian` take them, to second order",
        "Dynamics, Frame, ConstrainedDynamics.f and its derivatives take them",
    ),
    ("with the Jacobians J of `FreeKinematics`", "with J = Frame.jacobian(q)"),
    ("in --sample too, so", "in sample() too, so"),
    ("and so does --polish, where", "and so does solver={'polish': True}, where"),
    ("raise solver.time_limit or --time-limit", "raise solver.time_limit"),
    (", or use gains (--feedback)", ", or use feedback()"),
    ("(limits.infeasible of --json has all)", "(infeasible has all)"),
    (
        ", or use the generic code or the just-in-time compiler, which need no source text",
        ", or use costate.Dynamics, which needs no source text",
    ),
];

/// The message with the words of Python.
pub fn in_python(message: &str) -> String {
    WORDS.iter().fold(message.to_owned(), |text, (of_library, here)| text.replace(of_library, here))
}
