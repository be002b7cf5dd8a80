//! The files that `costate optimize` writes: report, figures, saved solution, samples, feedback.

use super::arguments::Arguments;
use crate::output::{Output, OutputFolder, is_standard};
use costate_control::{Problem, Samples, Solution};
use costate_report::ReportOptions;
use std::error::Error;
use std::path::{Path, PathBuf};

/// Outputs that were checked before the problem is solved.
pub struct Outputs {
    report: Option<Output>,
    figures: Option<Figures>,
    saved: Option<Output>,
    samples: Option<Output>,
    feedback: Option<Output>,
    /// Whether one of them goes to standard output.
    standard: bool,
}

/// A folder of figures.
struct Figures {
    path: PathBuf,
    folder: OutputFolder,
    inputs: Vec<PathBuf>,
}

impl Outputs {
    /// Checks that every output can be written and that none of them is an input or another output.
    ///
    /// # Errors
    /// A message that names the path.
    pub fn prepare(arguments: &Arguments, inputs: &[PathBuf]) -> Result<Self, String> {
        let files = [
            ("-o", &arguments.output),
            ("--save", &arguments.save),
            ("--sample-to", &arguments.sample_to),
            ("--feedback", &arguments.feedback),
        ];
        let named = files.iter().filter_map(|(name, path)| Some((*name, path.as_ref()?)));
        let standard = named.clone().filter(|(_, path)| is_standard(path)).count();
        if standard + usize::from(arguments.json) > 1 {
            return Err(
                "only one of --json, -o -, --save -, --sample-to - and --feedback - can use standard output"
                    .into(),
            );
        }
        for (k, (name, path)) in named.clone().enumerate() {
            if let Some((other, _)) = named.clone().take(k).find(|(_, other)| *other == path) {
                let path = path.display();
                return Err(format!("{path}: is the file of both {other} and {name}; choose two files"));
            }
        }
        let shows_samples = arguments.sample_to.is_some() || arguments.feedback.is_some() || arguments.json;
        if arguments.sample.is_some() && !shows_samples {
            return Err("--sample: nothing would show the samples; add --sample-to FILE or --json".into());
        }
        let all: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        let prepare =
            |path: &Option<PathBuf>| path.as_ref().map(|path| Output::prepare(path, &all)).transpose();
        let folder = |path: &PathBuf| -> Result<Figures, String> {
            Ok(Figures { path: path.clone(), folder: OutputFolder::prepare(path)?, inputs: inputs.to_vec() })
        };
        Ok(Self {
            report: prepare(&arguments.output)?,
            saved: prepare(&arguments.save)?,
            samples: prepare(&arguments.sample_to)?,
            feedback: prepare(&arguments.feedback)?,
            figures: arguments.svg.as_ref().map(folder).transpose()?,
            standard: standard > 0,
        })
    }

    /// Writes the feedback.
    ///
    /// # Errors
    /// A message that names the path.
    pub fn write_feedback(&self, text: &str) -> Result<(), Box<dyn Error>> {
        self.feedback.as_ref().map_or(Ok(()), |file| file.write(text))
    }

    /// Whether the report, the saved solution, the samples or the feedback go to standard output.
    pub fn use_standard_output(&self) -> bool {
        self.standard
    }

    /// Writes all outputs, the solution first.
    ///
    /// # Errors
    /// A message that names the path.
    pub fn write(
        &self,
        (problem, solution): (&Problem, &Solution),
        options: &ReportOptions,
        samples: Option<&Samples>,
    ) -> Result<(), Box<dyn Error>> {
        if let Some(saved) = &self.saved {
            saved.write(&solution.to_json_with_remarks(problem)?)?;
        }
        if let (Some(file), Some(samples)) = (&self.samples, samples) {
            file.write(&samples.to_csv(&solution.robot.joints))?;
        }
        if let Some(page) = &self.report {
            page.write(&costate_report::report(problem, solution, options))?;
        }
        if let Some(figures) = &self.figures {
            figures.write(&costate_report::figures_as_svg(problem, solution))?;
        }
        Ok(())
    }
}

impl Figures {
    fn write(&self, files: &[(String, String)]) -> Result<(), Box<dyn Error>> {
        let inputs: Vec<&Path> = self.inputs.iter().map(PathBuf::as_path).collect();
        for (name, text) in files {
            self.folder.file(name, &inputs)?.write(text)?;
        }
        self.remove_stale(files).map_err(|error| {
            format!("{}: figures of an earlier run cannot be removed ({error})", self.path.display()).into()
        })
    }

    /// Removes the figures of an earlier run that this one does not have: files with the name of a figure
    /// and the text of one. Everything else stays.
    fn remove_stale(&self, files: &[(String, String)]) -> std::io::Result<()> {
        for entry in std::fs::read_dir(&self.path)? {
            let entry = entry?;
            let name = entry.file_name();
            let Some(name) = name.to_str() else { continue };
            let is_new = files.iter().any(|(file, _)| file == name);
            if !is_new && entry.file_type()?.is_file() && costate_report::is_name_of_figure(name) {
                let is_figure =
                    std::fs::read_to_string(entry.path()).is_ok_and(|text| costate_report::is_figure(&text));
                if is_figure {
                    std::fs::remove_file(entry.path())?;
                }
            }
        }
        Ok(())
    }
}
