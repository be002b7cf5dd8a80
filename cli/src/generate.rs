//! `costate completions` and `costate man`: made from the definitions of the arguments.

use crate::Outcome;
use crate::output::{Output, OutputFolder, STANDARD};
use clap::{Command, ValueHint};
use clap_complete::Shell;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct CompletionArguments {
    /// Shell to complete for
    #[arg(value_enum)]
    shell: Shell,
}

#[derive(clap::Args)]
pub struct ManArguments {
    /// Folder to write to, one page per command [default: the main page to standard output]
    #[arg(value_hint = ValueHint::DirPath)]
    folder: Option<PathBuf>,
}

/// Writes the completion script of a shell to standard output.
pub fn completions(mut command: Command, arguments: &CompletionArguments) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "costate", &mut script);
    Output::prepare(Path::new(STANDARD), &[])?.write(&String::from_utf8(script)?)?;
    Ok(ExitCode::SUCCESS)
}

/// Writes the manual.
pub fn man(mut command: Command, arguments: &ManArguments) -> Outcome {
    command.build();
    match &arguments.folder {
        None => Output::prepare(Path::new(STANDARD), &[])?.write(&page(command)?)?,
        Some(folder) => {
            let folder = OutputFolder::prepare(folder)?;
            for command in command.get_subcommands().filter(|command| command.get_name() != "help") {
                let file = folder.file(&format!("costate-{}.1", command.get_name()), &[])?;
                file.write(&page(command.clone())?)?;
            }
            folder.file("costate.1", &[])?.write(&page(command)?)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn page(command: Command) -> Result<String, Box<dyn std::error::Error>> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page)?;
    Ok(String::from_utf8(page)?)
}
