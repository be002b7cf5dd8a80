//! Messages of the library in the words of its Python interface.

/// What messages advise on the command line and in Rust, and what does the same here.
const WORDS: [(&str, &str); 9] = [
    ("`costate info --frames` lists the names", "robot.frame_names lists the names"),
    ("request it by --friction (LoadOptions::friction)", "request it by friction=True"),
    ("give the format by --format (Robot::read)", "give the text and its format to Robot.from_text"),
    ("or give --format urdf", "or give the text and format=\"urdf\" to Robot.from_text"),
    ("or give --format toml", "or give the text and format=\"toml\" to Robot.from_text"),
    ("(--limit ", "(limit="),
    ("(--limit)", "(limit=...)"),
    ("or --only)", "or only=True)"),
    (
        ", or use the generic code or the just-in-time compiler, which need no source text",
        ", or use costate.Dynamics, which needs no source text",
    ),
];

/// The message with the words of Python.
pub fn in_python(message: &str) -> String {
    WORDS.iter().fold(message.to_owned(), |text, (of_library, here)| text.replace(of_library, here))
}
